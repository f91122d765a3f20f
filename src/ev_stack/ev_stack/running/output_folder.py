"""The folder that a command leaves behind, and which files there it may replace: those that it has written itself."""

from __future__ import annotations

import fcntl
import fnmatch
import glob
import os
from collections.abc import Iterable, Sequence
from contextlib import ExitStack, nullcontext, suppress
from pathlib import Path, PurePosixPath

from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.recording.outcome import announce
from ev_stack.recording.recording import BAG, BEFORE_RESET, LOG, PARAMETERS, RECORDED, free_path
from ev_stack.running.folder_content import (
    MANIFEST,
    Files,
    content,
    digest_of,
    is_file,
    is_folder,
    locked,
    read_manifest,
    stays_within,
    there,
    write_manifest,
)
from ev_stack.scenarios.records import Run

_NOT_WHOLE = f".*.{'[0-9a-f]' * 8}"  # how `atomic_file` calls what it is writing


class OutputFolder:
    """All that a command writes: `files` into a folder, those of a single run beside them, those of several in DIR/RUN.

    `writer` names the writer, such as "scenario shchur2019". The manifest of the folder names all
    files of each writer. At the beginning those of this one are removed, apart from `keeps`; what
    it was writing when it was killed is moved to earlier_1, earlier_2, ...; nothing else is
    touched. ParameterError before that if a name is taken by something else, or a file has changed
    since or is one that the command `reads`, or another command is writing there: the folder is
    locked up to the end of the block, where the manifest is completed.
    """

    def __init__(
        self,
        directory: Path,
        writer: str,
        files: Iterable[str] = (),
        runs: Sequence[Run] = (),
        keeps: Iterable[str] = (),
        reads: Iterable[Path | str | None] = (),
    ) -> None:
        self.directory = directory.absolute()
        self._given, self._writer, self._alone = directory, writer, len(runs) == 1
        self._handed_over = False
        folders = {run.name: "" if self._alone else glob.escape(run.name) for run in runs}
        self._shared = {"", *folders.values()}  # with what the user has there
        claims = [*map(glob.escape, files)]
        claims += [str(Path(folders[run.name], name)) for run in runs for name in files_of_run(run)]
        if any(letter == "\0" or "\ud800" <= letter <= "\udfff" for letter in str(self.directory)):
            raise ParameterError(
                f"{quoted(str(directory))} is refused, expected the name of a folder in UTF-8"
            )
        with ExitStack() as locks:
            try:
                self._hold(self.directory, locks)
                self._others = self._manifest()
                before = self._others.pop(writer, {})
                finished, unfinished = self._finished(before), self._unfinished(before)
                mine = {*finished, *unfinished}
                self._refuse_what_is_in_the_way(claims, mine)
                kept = mine.intersection(keeps)
                self._refuse_what_is_read(
                    mine - kept, runs, [Path(each).resolve() for each in reads if each]
                )
                for folder in {self.of(run) for run in runs} - {self.directory}:
                    self._hold(folder, locks)
                for name in finished.keys() - kept:
                    (self.directory / name).unlink()
                self._move(sorted(set(unfinished) - kept))
                self._prune([*map(glob.escape, mine), *claims], [self.of(run) for run in runs])
                self._files: Files = {
                    glob.escape(name): finished.get(name) for name in sorted(kept)
                }
                self._files |= dict.fromkeys(claims)
                self._write(self._files)
            except OSError as error:
                raise ParameterError(f"{directory}: {error.strerror or error}") from None
            self._locks = locks.pop_all()

    def of(self, run: Run) -> Path:
        """The folder of one run."""
        return self.directory if self._alone else self.directory / run.name

    def claim(self, names: Iterable[str]) -> None:
        """Let the command also write files of these names; ParameterError if there are such."""
        more = dict.fromkeys(glob.escape(name) for name in names)
        self._refuse_what_is_in_the_way(more, set())
        self._files |= more
        self._write(self._files)

    def hand_over(self) -> None:
        """Leave the manifest open at the end of the block: others, such as nodes by a launch file, write there then."""
        self._handed_over = True

    def __enter__(self) -> OutputFolder:
        return self

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        # What was put there by others while we drove is not ours, even if it has one of our names.
        theirs = {error.filename} if isinstance(error, FileExistsError) else set()
        with self._locks, suppress(OSError) if error else nullcontext():
            files: Files = {}
            for pattern, digest in self._files.items():
                found = [self.directory / name for name in there(self.directory, pattern)]
                ours = [path for path in found if is_file(path) and str(path) not in theirs]
                files |= {
                    path.relative_to(self.directory).as_posix(): digest or digest_of(path)
                    for path in ours
                }
                if self._handed_over and not ours:
                    files[pattern] = None
            self._write(files)

    def _hold(self, folder: Path, locks: ExitStack) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        try:
            locks.enter_context(locked(folder, fcntl.LOCK_EX | fcntl.LOCK_NB))
        except BlockingIOError:
            raise ParameterError(
                f"{folder}: another run is writing there, expected another folder"
            ) from None

    def _manifest(self) -> dict[str, Files]:
        try:
            return read_manifest(self.directory)
        except (ValueError, RecursionError):
            raise self._refused(MANIFEST, "is not a manifest of ours") from None

    def _write(self, files: Files) -> None:
        write_manifest(self.directory, {**self._others, **({self._writer: files} if files else {})})

    def _finished(self, before: Files) -> Files:
        """What is as the writer has left it; a file that the user has removed is simply gone."""
        finished = {}
        for name, digest in before.items():
            if digest and [name] == list(there(self.directory, glob.escape(name))):
                if not is_file(self.directory / name) or digest_of(self.directory / name) != digest:
                    raise self._refused(name, "was changed since")
                finished[name] = digest
        return finished

    def _unfinished(self, before: Files) -> list[str]:
        """What the writer was writing when it was killed, also under the name of a file that is not whole yet."""
        found, names = [], {}
        for pattern in (pattern for pattern, digest in before.items() if digest is None):
            found += there(self.directory, pattern)
            folder, slash, name = pattern.rpartition("/")
            names.setdefault(folder + slash, []).append(name)
        for folder, of_folder in names.items():
            for each in there(self.directory, folder + _NOT_WHOLE):
                whole = each.rpartition("/")[2][1:].rpartition(".")[0]
                found += (
                    [each] if any(fnmatch.fnmatchcase(whole, name) for name in of_folder) else []
                )
        return [name for name in found if is_file(self.directory / name)]

    def _refuse_what_is_in_the_way(self, claims: Iterable[str], mine: set[str]) -> None:
        """ParameterError if a name is taken by what is not `mine`, or its folder, which is ours alone, holds such."""
        files, places = [*claims], set()
        for pattern in files:
            if not stays_within(pattern):
                raise ParameterError(
                    f"{self._given}: {quoted(pattern)} is refused, expected the name of a file there"
                )
            folder = pattern.rpartition("/")[0]
            places.add(pattern if folder in self._shared else folder)
        for place in sorted(places):
            for name in there(self.directory, place):
                if place in files and is_folder(self.directory / name):
                    raise self._refused(name, "is a folder")
                for each in content(self.directory, name):
                    if each not in mine:
                        raise self._refused(name, self._whose(each))

    def _refuse_what_is_read(
        self, names: Iterable[str], runs: Iterable[Run], reads: Sequence[Path]
    ) -> None:
        """ParameterError if one of these files, which would be lost, is read or lies in a folder that is, not deeper.

        A run also reads the recordings that its methods play back.
        """
        methods = [
            configuration.method for run in runs for configuration in run.configurations.values()
        ]
        recordings = {Path(method.name).resolve() for method in methods if method.plays_back}
        for name in names:
            path = (self.directory / name).resolve()
            if path in recordings:
                raise self._refused(name, "is what is played back")
            if path in reads or path.parent in reads:
                raise self._refused(name, "is what this command reads")

    def _whose(self, name: str) -> str:
        if (self.directory / name).is_symlink():
            return "is a link"
        writers = (f"is of {writer}" for writer, files in self._others.items() if name in files)
        return next(writers, "is not of an earlier run")

    def _refused(self, name: str, why: str) -> ParameterError:
        return ParameterError(f"{self._given}: {name} there {why}, expected another folder")

    def _move(self, names: Sequence[str]) -> None:
        earlier = free_path(self.directory / "earlier_")
        for name in names:
            (earlier / name).parent.mkdir(parents=True, exist_ok=True)
            (self.directory / name).rename(earlier / name)
        if names:
            announce(f"note: what an earlier run had not finished is in {earlier} now")

    def _prune(self, names: Iterable[str], but: Sequence[Path]) -> None:
        """Remove what is empty of the folders that files of these patterns were or will be in."""
        folders = {str(folder) for name in names for folder in PurePosixPath(name).parents} - {"."}
        for pattern in sorted(folders, reverse=True):  # the inner ones first
            for found in there(self.directory, pattern):
                if self.directory / found not in but:
                    with suppress(OSError):
                        os.rmdir(self.directory / found)


def forget_recording(directory: Path) -> None:
    """Remove what the recorder of a run has written into its folder, so that another one may begin there."""
    for pattern in RECORDED:
        for name in there(directory, pattern):
            (directory / name).unlink()
    if is_folder(directory / BAG):
        (directory / BAG).rmdir()


def files_of_run(run: Run) -> Iterable[str]:
    """Patterns of all files that can be there when a run has ended, however it has."""
    yield from (PARAMETERS, *RECORDED, *BEFORE_RESET)
    yield from (f"{LOG}/{glob.escape(name)}.log" for name in (*run.configurations, RECORDER))
    gateway = run.configurations.get("inverter_gateway")
    if gateway and gateway.parameters.bus.log:
        yield glob.escape(gateway.parameters.bus.log)
