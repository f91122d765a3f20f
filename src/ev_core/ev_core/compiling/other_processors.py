"""A function `step` as an object file for another processor than this one, with the same bits.

The compiler's text of a function (LLVM) is the same for all processors. It is taken before machine
code is made of it, and without the frame by which Python calls it. So an object file calls nothing
but what `Processor.may_call` lists.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from ev_core.compiling import inside_numba
from ev_core.compiling.code_store import kept_file, key_of
from ev_core.compiling.machine_code import Code, executed, made_by_others, register_functions
from ev_core.compiling.object_symbols import calls
from ev_core.compiling.user_cache import alone, read_checked, write_checked
from ev_msgs_py.refusal import ParameterError

# Exact in every C library: what fills memory, takes a number's exponent apart or changes it, and a
# remainder.
_EVERYWHERE = frozenset(("memset", "frexp", "ldexp", "fmod"))
_PAGES = "___chkstk_ms"  # touches the pages of a large frame one by one, as Windows asks for
# What C compilers bring for 32-bit Arm: memory, integers of 64 bits and their conversions, all
# exact. And what these processors have no instruction for.
_OF_ARM = frozenset(
    """
    __aeabi_memset __aeabi_memset4 __aeabi_memset8 __aeabi_memclr __aeabi_memclr4 __aeabi_memclr8
    __aeabi_d2lz __aeabi_d2ulz __aeabi_l2d __aeabi_ul2d
    __aeabi_lmul __aeabi_ldivmod __aeabi_uldivmod
    floor ceil rint
    """.split()  # noqa: SIM905
)
# And numbers of 64 bits where there are only those of 32 bits; IEEE 754 defines every result.
_SOFT = frozenset(
    """
    __aeabi_dadd __aeabi_dsub __aeabi_drsub __aeabi_dmul __aeabi_ddiv
    __aeabi_d2f __aeabi_f2d __aeabi_d2iz __aeabi_d2uiz __aeabi_i2d __aeabi_ui2d
    __aeabi_dcmpeq __aeabi_dcmplt __aeabi_dcmple __aeabi_dcmpge __aeabi_dcmpgt __aeabi_dcmpun
    __aeabi_llsl __aeabi_llsr __aeabi_lasr
    sqrt
    """.split()  # noqa: SIM905
)
_CALLED = """
define i32 @{symbol}(ptr %now, ptr %next, ptr %state, ptr %constants) {{
  %given = alloca i32
  %raised = alloca ptr
  %status = call i32 @{name}(
      ptr %given, ptr %raised, ptr %now, ptr %next, ptr %state, ptr %constants)
  ret i32 %status
}}
"""
# A law with checked indices looks in `raised` for an exception before it raises one, and gives a
# status itself.
_CALLED_CHECKED = """
define i32 @{symbol}(ptr %now, ptr %next, ptr %state, ptr %constants) {{
  %given = alloca i32
  %raised = alloca ptr
  store i32 1, ptr %given
  store ptr null, ptr %raised
  %failed = call i32 @{name}(
      ptr %given, ptr %raised, ptr %now, ptr %next, ptr %state, ptr %constants)
  %status = load i32, ptr %given
  %either = or i32 %failed, %status
  ret i32 %either
}}
"""
_HEAD = re.compile(r"^(source_filename|target datalayout|target triple) = .*$", re.M)
_SHARED = re.compile(r"= common (local_unnamed_addr )?global")
# Counts of holders of an array, which need none: a part works on arrays that its caller holds.
_COUNTED = re.compile(r"^define linkonce_odr void @(NRT_(?:inc|dec)ref)\(.*?^}$", re.M | re.S)
_UNCOUNTED = r"define internal void @\1(ptr %0) {\n  ret void\n}"
_EXPONENTS = re.compile(r"@numba_(frexp|ldexp)\b")
# A structure with a pointer is shorter where pointers have 32 bits; the text may count its bytes
# already.
_OF_POINTERS = re.compile(r"= alloca [\[{][^\n]*\bptr\b")


class Processor(NamedTuple):
    """Settings of LLVM for a processor and its system.

    `may_call` are the functions that its C compiler brings.
    """

    triple: str
    cpu: str
    features: str = ""
    may_call: frozenset[str] = _EVERYWHERE

    @property
    def machine(self) -> Any:
        """The code generator; the code may be loaded anywhere."""
        from llvmlite import binding

        binding.initialize_all_targets()
        binding.initialize_all_asmprinters()
        target = binding.Target.from_triple(self.triple)
        return target.create_target_machine(self.cpu, self.features, 3, "pic", "default")


X86_64_LINUX = Processor("x86_64-unknown-linux-gnu", "x86-64-v2")
X86_64_WINDOWS = Processor("x86_64-w64-windows-gnu", "x86-64-v2", "", _EVERYWHERE | {_PAGES})
AARCH64_LINUX = Processor("aarch64-unknown-linux-gnu", "generic")
ARM_LINUX = Processor("armv7-unknown-linux-gnueabihf", "generic", "+vfp4", _EVERYWHERE | _OF_ARM)
CORTEX_M4 = Processor(
    "thumbv7em-unknown-none-eabihf", "cortex-m4", "", _EVERYWHERE | _OF_ARM | _SOFT
)


def object_file(code: Code, symbol: str, processor: Processor) -> bytes:
    """The object file of a text's function under the name `symbol`.

    int32 symbol(now, next, state, constants). It returns 0, and something else where the function
    has raised an exception, or answers so. ParameterError if it calls what may not be there.
    """
    from llvmlite import binding

    name, text = _of_compiler(code)
    text = _EXPONENTS.sub(
        r"@\1", _COUNTED.sub(_UNCOUNTED, _SHARED.sub("= internal global", _HEAD.sub("", text)))
    )
    machine = processor.machine
    head = f'target triple = "{processor.triple}"\ntarget datalayout = "{machine.target_data}"\n'
    called = _CALLED_CHECKED if "boundscheck=True" in code.text else _CALLED
    module = binding.parse_assembly(f"{head}{text}{called.format(symbol=symbol, name=name)}")
    for function in module.functions:
        function.add_function_attribute("nounwind")
        if function.name != symbol and not function.is_declaration:
            function.linkage = "internal"
    # only for functions without callers: all is optimised already
    passes = binding.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(
        module, binding.create_pass_builder(machine, binding.create_pipeline_tuning_options())
    )
    if "p:32:32" in str(machine.target_data) and _OF_POINTERS.search(str(module)):
        raise ParameterError(
            f"{code.name} is refused for {processor.triple}, it keeps pointers in working memory"
        )
    made: bytes = machine.emit_object(module)
    foreign = sorted({*calls(made)} - processor.may_call)
    if any(name.startswith("NRT_") for name in foreign):
        raise ParameterError(
            f"{code.name} is refused, it makes a list or an array in a step, which needs a heap"
        )
    if foreign:
        raise ParameterError(
            f"{code.name} is refused, its code calls {', '.join(foreign)}, which is not everywhere"
        )
    return made


def _of_compiler(code: Code) -> tuple[str, str]:
    """The name of the function and its optimised text; taken from disk where that is kept."""
    key = key_of(*code)
    file = kept_file(key, "llvm")
    with alone(f"{key}.llvm"):
        kept = read_checked(file)
        if kept is None:
            # Nothing becomes machine code, which would change the text.
            with inside_numba.only_machine_code_of("", made_by_others(code.text, code.names)):
                register_functions()
                step = executed(f"{key}_llvm", code.text, code.names)
            kept = f"{step.native_name.removeprefix('cfunc.')}\n{step.inspect_llvm()}".encode()
            write_checked(file, kept)
    name, _, text = kept.decode().partition("\n")
    return name, text
