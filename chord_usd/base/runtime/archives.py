"""Zip archives from strangers (.zip, .usdz, .sh3f, .sh3d): looked at before anything is read.

What an archive says of itself is not believed: its names are checked, and reading stops at a limit
whatever its headers say. Nothing else in the package opens an archive or a file by a name in one.
"""

from __future__ import annotations

import io
import re
import stat
import struct
import unicodedata
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from types import TracebackType

from chord_usd.base.errors import ChordError

MOST_BYTES = 4 * 2**30
"""Unpacked; the largest Sweet Home 3D library has less than a tenth of this."""

MOST_RATIO = 300
"""Unpacked against packed. Text of meshes shrinks to a tenth, zeros to a thousandth."""

MOST_ENTRIES = 60_000
_DIRECTORY_BYTES = MOST_ENTRIES * 400
_RATIO_FROM_BYTES = 10 * 2**20
_NAME_BYTES, _PATH_BYTES = 255, 1024
"""What file systems hold of one name, and of a whole path below the folder."""

_CHUNK_BYTES = 2**20
_LOCAL_HEADER = struct.Struct("<4s5H3L2H")
_FLAG_ENCRYPTED, _FLAG_SIZES_LATER = 0x1, 0x8
_UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f]")

_DAMAGE = (
    zipfile.BadZipFile, zlib.error, struct.error, EOFError, NotImplementedError, RuntimeError,
    OSError, ValueError, OverflowError,
)  # fmt: skip
"""What zipfile raises for archives that are none, or not whole."""


class Archive:
    """A zip archive whose directory has been looked through. A context manager."""

    def __init__(
        self, path: Path, error: type[ChordError], *, expected: str = "a zip archive"
    ) -> None:
        """Open the archive at path.

        error: the class of every error that is raised, that of the caller's domain. expected: what
        the file should have been, in errors. Raises error for an archive that is damaged, encrypted
        or far too large when unpacked, or that names files outside itself, links, or one file
        twice.
        """
        self.path, self._error, self._expected = path, error, expected
        try:
            # A pipe would wait for its writer for ever.
            if not stat.S_ISREG(path.stat().st_mode):
                raise self._refused("it is no regular file")
            self._file = path.open("rb")
        except OSError as reason:
            raise self._damaged(reason) from None
        try:
            self._zip = self._checked()
        except BaseException:
            self._file.close()
            raise
        self._entries = {_key(entry.filename): entry for entry in self._zip.infolist()}

    def __enter__(self) -> Archive:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._zip.close()
        self._file.close()

    @property
    def names(self) -> list[str]:
        """The files in it, in the order of its directory; without folders."""
        return [entry.filename for entry in self._zip.infolist() if not entry.is_dir()]

    def read(self, name: str, most_bytes: int | None = None) -> bytes:
        """The bytes of a file. Raises the archive's error where it has no such file, where that is
        damaged or holds more than most_bytes, by default MOST_BYTES."""
        data = io.BytesIO()
        for chunk in self._chunks(name, most_bytes):
            data.write(chunk)
        return data.getvalue()

    def unpack(self, folder: Path, names: Iterable[str] | None = None) -> None:
        """Write files, by default all of them, below a folder that is the caller's own.

        What is there already is an error and stays as it is. Raises the archive's error, and
        OSError where the folder cannot be written.
        """
        for name in self.names if names is None else names:
            place = folder.joinpath(*PurePosixPath(self._entry(name).filename).parts)
            place.parent.mkdir(parents=True, exist_ok=True)
            with place.open("xb") as file:
                for chunk in self._chunks(name):
                    file.write(chunk)

    def require_package(self) -> None:
        """Raises the archive's error for what is no .usdz by its specification.

        All of it is stored as it is, and the local headers say what the directory says: USD reads
        those, this class reads the directory, and both must see the same files.
        """
        offset = 0
        for entry in self._zip.infolist():
            if entry.compress_type != zipfile.ZIP_STORED:
                raise self._refused(f"{entry.filename!r} is compressed")
            if offset != entry.header_offset or entry.flag_bits & _FLAG_SIZES_LATER:
                raise self._refused(f"{entry.filename!r} does not lie where its directory says")
            offset = self._end_of(entry)
        if not self.names or offset != self._zip.start_dir:
            raise self._refused("its files and its directory do not agree")

    def _end_of(self, entry: zipfile.ZipInfo) -> int:
        """Where an entry's bytes end, by its local header."""
        self._file.seek(entry.header_offset)
        header = self._file.read(_LOCAL_HEADER.size)
        if len(header) != _LOCAL_HEADER.size:
            raise self._refused("it is cut off")
        fields = _LOCAL_HEADER.unpack(header)
        sizes, name_length, extra_length = fields[7:9], fields[9], fields[10]
        name = self._file.read(name_length).decode("utf-8", "replace")
        listed = (entry.compress_size, entry.file_size)
        if fields[0] != b"PK\x03\x04" or name != entry.orig_filename or sizes != listed:
            raise self._refused(f"{entry.filename!r} does not lie where its directory says")
        return entry.header_offset + len(header) + name_length + extra_length + listed[0]

    def _entry(self, name: str) -> zipfile.ZipInfo:
        entry = self._entries.get(_key(name))
        if entry is None or entry.is_dir() or entry.filename != name:
            raise self._refused(f"it holds no {name}")
        return entry

    def _chunks(self, name: str, most_bytes: int | None = None) -> Iterator[bytes]:
        entry = self._entry(name)
        most = MOST_BYTES if most_bytes is None else most_bytes
        done = 0
        with self._reading(), self._zip.open(entry) as file:
            while True:
                # One byte more than is allowed shows a lie in the header.
                chunk = file.read(min(_CHUNK_BYTES, most - done + 1))
                if not chunk:
                    break
                done += len(chunk)
                if done > most:
                    raise self._refused(f"{name} unpacks to more than {most:,} bytes")
                yield chunk
            if done != entry.file_size:
                raise self._refused(f"{name} is shorter than its header says")

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except _DAMAGE as reason:
            raise self._damaged(reason) from None

    def _checked(self) -> zipfile.ZipFile:
        """The archive, once its directory has been found sound."""
        if _directory_bytes(self.path) > _DIRECTORY_BYTES:
            raise self._refused(f"its directory names more than {MOST_ENTRIES} files")
        with self._reading():
            archive = zipfile.ZipFile(self._file)
        entries = archive.infolist()
        self._refuse_sizes(entries)
        for entry in entries:
            self._refuse_name(entry.orig_filename)
            self._refuse_kind(entry)
        self._refuse_doubles(entries)
        self._refuse_overlaps(archive)
        return archive

    def _refuse_sizes(self, entries: list[zipfile.ZipInfo]) -> None:
        size = sum(entry.file_size for entry in entries)
        packed = max(sum(entry.compress_size for entry in entries), 1)
        if size > MOST_BYTES or len(entries) > MOST_ENTRIES:
            raise self._error(
                f"the archive unpacks to {size / 2**30:.1f} GB in {len(entries)} files",
                where=str(self.path),
                expected=f"at most {MOST_BYTES / 2**30:.0f} GB and {MOST_ENTRIES} files",
            )
        if size > _RATIO_FROM_BYTES and size / packed > MOST_RATIO:
            raise self._error(
                f"the archive unpacks to {size / packed:.0f} times its size",
                where=str(self.path),
                expected=f"at most {MOST_RATIO} times; this looks like a zip bomb",
            )

    def _refuse_name(self, name: str) -> None:
        parts = PurePosixPath(name).parts
        if name.startswith("/") or ".." in parts or "\\" in name or ":" in name:
            raise self._error(
                f"the archive names a file outside itself: {name!r}",
                where=str(self.path),
                expected="names relative to the archive, with / between folders",
            )
        long = any(len(_bytes(part)) > _NAME_BYTES for part in parts)
        if not parts or _UNPRINTABLE.search(name) or long or len(_bytes(name)) > _PATH_BYTES:
            raise self._refused(f"{_shortened(name)!r} is no name of a file")

    def _refuse_kind(self, entry: zipfile.ZipInfo) -> None:
        if entry.flag_bits & _FLAG_ENCRYPTED:
            raise self._refused(f"{entry.filename!r} is encrypted")
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise self._refused(f"{entry.filename!r} is packed in an unusual way")
        # Archives from Windows have no mode at all.
        kind = stat.S_IFMT(entry.external_attr >> 16)
        if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
            raise self._refused(f"{entry.filename!r} is a link or a device, not a file")

    def _refuse_doubles(self, entries: list[zipfile.ZipInfo]) -> None:
        """Names that would be one file on some file system, or a file and a folder at once."""
        seen: set[str] = set()
        files: set[str] = set()
        for entry in entries:
            key = _key(entry.filename)
            if key in seen:
                raise self._refused(f"{entry.filename!r} is in it twice")
            seen.add(key)
            if not entry.is_dir():
                files.add(key)
        for key in seen:
            above = {str(parent) for parent in PurePosixPath(key).parents}
            if above & files:
                raise self._refused(f"{key!r} lies in a file")

    def _refuse_overlaps(self, archive: zipfile.ZipFile) -> None:
        """Entries that share their bytes: a bomb that no ratio of one entry shows."""
        end = 0
        for entry in sorted(archive.infolist(), key=lambda info: info.header_offset):
            if entry.header_offset < end:
                raise self._refused(f"{entry.filename!r} shares its bytes with another file")
            end = entry.header_offset + _LOCAL_HEADER.size + entry.compress_size
        if end > archive.start_dir:
            raise self._refused("it is cut off")

    def _refused(self, why: str) -> ChordError:
        return self._error(f"the archive is refused: {why}", where=str(self.path),
                           expected=self._expected)  # fmt: skip

    def _damaged(self, reason: BaseException) -> ChordError:
        return self._error(f"the archive is damaged ({_shortened(str(reason))})",
                           where=str(self.path), expected=self._expected)  # fmt: skip


def pack_folder(folder: Path, target: Path, name: str) -> None:
    """A folder of our own as a zip with one folder, of this name, in it; hidden files stay."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=3) as archive:
        for file in sorted(folder.rglob("*")):
            inside = file.relative_to(folder)
            if file.is_file() and not any(part.startswith(".") for part in inside.parts):
                archive.write(file, Path(name) / inside)


def _directory_bytes(path: Path) -> int:
    """What the archive says of the size of its directory: zipfile would read all of it at once.

    Of several ends of a directory the largest counts; which one zipfile takes is its own affair.
    """
    with path.open("rb") as file:
        file.seek(0, io.SEEK_END)
        file.seek(max(0, file.tell() - 2**16 - 22 - 76))
        tail = file.read()
    plain = (struct.unpack_from("<L", tail, m.start() + 12)[0]
             for m in re.finditer(b"PK\x05\x06", tail) if m.start() + 16 <= len(tail))  # fmt: skip
    large = (struct.unpack_from("<Q", tail, m.start() + 40)[0]
             for m in re.finditer(b"PK\x06\x06", tail) if m.start() + 48 <= len(tail))  # fmt: skip
    # All ones say that the figure stands in the larger record.
    return max((size for size in (*plain, *large) if size != 0xFFFFFFFF), default=0)


def _key(name: str) -> str:
    """What a name is to a file system that knows neither case nor forms of accents."""
    return unicodedata.normalize("NFC", str(PurePosixPath(name))).casefold()


def _bytes(name: str) -> bytes:
    return name.encode("utf-8", "surrogatepass")


def _shortened(text: str) -> str:
    return text if len(text) <= 120 else f"{text[:117]}..."
