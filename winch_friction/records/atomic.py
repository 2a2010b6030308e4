"""Writing files so that a reader sees the old content or the new, never half of it, and nothing is replaced unasked.

What a kill in the moment of renaming leaves beside a file is removed by the next one who writes or reads it anew.
"""

import errno
import glob
import os
import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkdtemp

_ONLY_NEW: set[str] = set()  # places at which nothing was, until this process has written there
MEANWHILE = "was made meanwhile by another command, and is not replaced; give another name"


def taken(path: Path, overwrite: bool = False) -> bool:
    """Whether something is at a place, a link to nothing as well. Without `overwrite` this process then writes there
    only if nothing is there yet at that moment: two that began at the same time had both found nothing."""
    (_ONLY_NEW.discard if overwrite else _ONLY_NEW.add)(os.path.abspath(path))
    return os.path.lexists(path)


def put(made: Path, path: Path, new: bool = False) -> None:
    """Move what was made to its place; `FileExistsError` where something must not be replaced: at a `new` place,
    or at one that was found not to be `taken`."""
    key = os.path.abspath(path)
    if not new and key not in _ONLY_NEW:
        os.replace(made, path)
        return
    try:
        _claim(made, path)
    except FileExistsError:
        raise FileExistsError(errno.EEXIST, MEANWHILE, str(path)) from None
    _ONLY_NEW.discard(key)


def _claim(made: Path, path: Path) -> None:
    if made.is_dir():
        path.mkdir()  # an empty folder is replaced
    else:
        try:
            os.link(made, path)
            made.unlink()
            return
        except FileExistsError:
            raise
        except OSError:  # a file system without links to files
            os.close(os.open(path, os.O_CREAT | os.O_EXCL))
    os.replace(made, path)


@contextmanager
def writing(path: Path, own: str) -> Iterator[None]:
    """What the system refuses while a file is written is said of `path`, the file that was asked for: a full disk names
    none, or the temporary one, whose name begins as `own`. What is said of other files stays."""
    try:
        yield
    except OSError as error:
        if error.filename is not None and not str(error.filename).startswith(own):
            raise
        said = f"cannot be written ({error.strerror or error}); make room there, or give another place"
        raise OSError(error.errno or errno.EIO, said, str(path)) from error


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """A temporary path beside `path` that replaces it when the block ends without an error, and vanishes otherwise.

    What a process that was killed left there is removed by the next one that writes the same file.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    remove_stale(path)
    temporary = _beside(path)
    try:
        temporary.touch(mode=0o600)
    except OSError as error:  # nobody knows the temporary file's name
        raise OSError(error.errno, f"cannot be written ({error.strerror}); give another place", str(path)) from None
    try:
        with writing(path, str(temporary)):
            yield temporary
            _flush_to_disk(temporary)
            os.chmod(temporary, 0o666 & ~_umask())
            put(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def together(folder: Path, mark: str) -> Iterator[Path]:
    """A hidden folder within `folder`, whose files move there when the block ends without an error, `mark` first.

    The mark says whose `folder` is: a process that is killed before has left none of its files there, and one that is
    killed between them has left the mark. What it left of the hidden folder is removed by the next one.
    """
    own = Path(folder) / Path(mark).stem
    own.parent.mkdir(parents=True, exist_ok=True)
    remove_stale(own)
    temporary = _beside(own)
    temporary.mkdir()
    try:
        yield temporary
        for each in sorted(temporary.iterdir(), key=lambda path: (path.name != mark, path.name)):
            put(each, own.parent / each.name)
    except OSError as error:  # nobody knows the hidden folder
        named = Path(str(error.filename or ""))
        if named.parent != temporary:
            raise
        raise OSError(error.errno, error.strerror, str(own.parent / named.name)) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def write_text(path: Path, text: str) -> Path:
    """Write a text file atomically; where the system can, in a file that has no name before it is whole."""
    path, content = Path(path), text.encode("utf-8")
    path.parent.mkdir(parents=True, exist_ok=True)
    remove_stale(path)
    with writing(path, str(_beside(path))):
        whole = _write_nameless(path, content)
    if not whole:
        with atomic_path(path) as temporary:
            temporary.write_bytes(content)
    return path


def _write_nameless(path: Path, content: bytes) -> bool:
    """False where there are no files without a name (not Linux, or a network's file system)."""
    flags = getattr(os, "O_TMPFILE", None)
    if flags is None:
        return False
    try:
        handle = os.open(path.parent, flags | os.O_RDWR, 0o666)
    except OSError:
        return False
    with os.fdopen(handle, "wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(handle)
        temporary = _beside(path)
        temporary.unlink(missing_ok=True)
        try:
            os.link(f"/proc/self/fd/{handle}", temporary, follow_symlinks=True)
        except OSError:  # no /proc
            return False
    try:
        put(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    return True


def _beside(path: Path) -> Path:
    """The temporary file of this process and thread; its name says whose it is."""
    return path.with_name(f".{path.stem}.{os.getpid()}-{threading.get_ident()}.tmp{path.suffix}")


def own_folder(path: Path) -> Path:
    """A new hidden folder beside a place, for what is to be moved there; its name says whose it is."""
    return Path(mkdtemp(dir=path.parent, prefix=f".{path.stem}.{os.getpid()}-", suffix=f".tmp{path.suffix}"))


def remove_stale(path: Path) -> None:
    """Remove what processes that are no more left beside a file."""
    for each in path.parent.glob(f".{_literal(path.stem)}.*-*.tmp{_literal(path.suffix)}"):
        owner = each.name.removeprefix(f".{path.stem}.").partition("-")[0]
        if owner.isdigit() and not _alive(int(owner)):
            shutil.rmtree(each) if each.is_dir() else each.unlink(missing_ok=True)


def _literal(text: str) -> str:
    return glob.escape(text)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # somebody else's
        return True
    return True


def _flush_to_disk(path: Path) -> None:
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
