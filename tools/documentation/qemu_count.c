/* Counts the instructions of a program that qemu-user emulates (qemu -plugin), and prints their number at its end.
 *
 * Debian brings no header of QEMU's plugins: these are the few declarations that are used, of which no version of the
 * interface has changed more than its number, API.
 */
#include <inttypes.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define EXPORTED __attribute__((visibility("default")))

struct qemu_plugin_tb; /* some instructions that are executed one after the other */
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
void qemu_plugin_register_vcpu_tb_trans_cb(uint64_t id, void (*call)(uint64_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *block, void (*call)(unsigned, void *), int, void *given);
void qemu_plugin_register_atexit_cb(uint64_t id, void (*call)(uint64_t, void *), void *given);

EXPORTED int qemu_plugin_version = API;

static uint64_t instructions;

static void executed(unsigned processor, void *count) { instructions += (uintptr_t)count; }

static void translated(uint64_t id, struct qemu_plugin_tb *block)
{
    qemu_plugin_register_vcpu_tb_exec_cb(block, executed, 0, (void *)qemu_plugin_tb_n_insns(block));
}

static void ended(uint64_t id, void *given) { fprintf(stderr, "%" PRIu64 "\n", instructions); }

EXPORTED int qemu_plugin_install(uint64_t id, const void *of_emulator, int count, char **words)
{
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, ended, 0);
    return 0;
}
