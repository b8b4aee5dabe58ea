"""Recordings: found by path, glob, URL or name, and hashed.

In: the sequences of a suite. Out: Recordings, each with the hash of its bytes, which is computed once and kept in
RESULTS/inputs by size, modification time and inode of each file."""

import glob
import os
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from .durations import pixels_of_files
from .errors import BatchError
from .files import hash_of_file, hash_of_value, kind_of, make_folder, read_json, write_json

PROBE_PATIENCE_S = 600  # a bag without an index is read whole
# What `kinloop fetch` knows, or knows how to ask for.
DATASET_NAME = re.compile(r"(tum|eth3d|icl|7scenes|bonn|replica|scannet|openloris)/[a-z0-9_-]+(/[a-z0-9_-]+)?")


@dataclass
class Recording:
    """`path` is what `kinloop run` opens; `identity` goes into the key of a run. `pixels`: of all its frames, about; 0 if it
    is simulated."""

    name: str
    dataset: str
    path: str
    camera: str
    truth: str
    identity: dict
    pixels: float


def is_url(pattern):
    return re.match(r"[a-z0-9+]{2,}://", pattern) is not None


def is_simulated(pattern):
    return pattern.startswith("sim:")


class Hashes:
    """Hashes of files and folders, kept in a folder."""

    def __init__(self, folder):
        self.folder = make_folder(folder)

    def of(self, path):
        """Returns the hash of the names and bytes below `path`, and (path, size in bytes) of each file. What is no file
        counts by its name and kind."""
        path = Path(path)
        cache = self.folder / (hash_of_value(str(path))[:32] + ".json")
        known = read_json(cache)
        now, parts, sizes = {}, [], []
        for file, name in entries_below(path):
            stamp = _stamp_of(file)
            if stamp is None:
                parts.append([name, kind_of(file)])
                continue
            now[name] = self._known(known, name, stamp) or [*stamp, hash_of_file(file)]
            parts.append([name, now[name][3]])
            sizes.append((file, stamp[0]))
        if now != known:
            write_json(cache, now)
        return hash_of_value(parts), sizes

    @staticmethod
    def _known(known, name, stamp):
        """The entry of a file that has not changed since; the cache may be damaged."""
        entry = known.get(name) if isinstance(known, dict) else None
        return entry if isinstance(entry, list) and entry[:3] == stamp and [type(e) for e in entry[3:]] == [str] else None


def _stamp_of(file):
    """What changes with the bytes of a file; None if it is no file or cannot be read."""
    if kind_of(file) != "file" or not os.access(file, os.R_OK):
        return None
    state = os.stat(file)
    return [state.st_size, state.st_mtime_ns, state.st_ino]


def entries_below(path):
    """(path, name below `path`) of all that is below a folder, sorted by name; of a file, itself."""
    if kind_of(path) != "folder":
        return [(path, "")]
    folders = folders_below(path)
    entries = {os.path.join(folder, name) for folder in folders for name in _names_in(folder)} - set(folders)
    return sorted(((entry, os.path.relpath(entry, path)) for entry in entries), key=lambda entry: entry[1])


def folders_below(path):
    """A folder and those below it. One to which several links lead is listed once, so that a link to a folder above ends."""
    folders, seen = [str(path)], {_identity_of(path)}
    for folder in folders:  # which grows
        for name in _names_in(folder):
            entry = os.path.join(folder, name)
            if kind_of(entry) == "folder" and _identity_of(entry) not in seen:
                seen.add(_identity_of(entry))
                folders.append(entry)
    return folders


def _identity_of(folder):
    state = os.stat(folder)
    return state.st_dev, state.st_ino


def _names_in(folder):
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []  # as if it were empty: the program cannot read it either


def camera_of(path, program):
    """The camera with which `kinloop run` would map a recording, as the text of camera.yaml; it may be in a file beside the
    recording. Empty if there is none: such a run fails, and is another one once there is a camera."""
    try:
        done = subprocess.run([program, "probe", "--print-camera", str(path)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              timeout=PROBE_PATIENCE_S, check=False)  # fmt: skip
        return done.stdout.decode(errors="replace") if done.returncode == 0 else ""
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BatchError(f"{path}: {program} probe --print-camera gives no answer ({error})") from None


def download(url, folder):
    """Copies what is at a URL of fsspec below `folder`, once; returns its path."""
    try:
        import fsspec
    except ImportError:
        raise BatchError(f"{url}: fsspec is missing: pip install 'kinloop[batch]', or copy the recording yourself") from None
    target = Path(folder) / hash_of_value(url)[:16] / url.rstrip("/").rsplit("/", 1)[-1]
    if target.exists():
        return target
    beside = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    make_folder(target.parent)
    try:
        files, path = fsspec.core.url_to_fs(url)
        files.get(path.rstrip("/"), str(beside), recursive=files.isdir(path))
        os.replace(beside, target)
    except Exception as error:  # each store has its own
        raise BatchError(f"{url}: cannot be fetched ({type(error).__name__}: {error})".split("\n")[0]) from None
    return target


def fetch_by_name(name, program, folder):
    """Has `kinloop fetch` download a sequence such as tum/fr1_room, unless it is there; returns its path."""
    done = subprocess.run([program, "fetch", name, "-o", str(make_folder(folder))], stderr=subprocess.PIPE, stdout=subprocess.PIPE,
                          text=True, errors="replace", check=False)  # fmt: skip
    path = Path((done.stdout.splitlines() or ["nowhere"])[0])
    if done.returncode or not path.is_dir():
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise BatchError(f"{name}: kinloop fetch failed: {last.removeprefix('error: ')}")
    return path


def matching(pattern):
    """The paths that match a glob, in which `**` stands for any folders that are not hidden."""
    before, *after = re.split(r"/\*\*(?=/|$)", pattern, maxsplit=1)
    if not after:
        return set(glob.glob(pattern))
    folders = {folder for base in glob.glob(before or "/") for folder in folders_below(base) if "/." not in folder[len(base) :]}
    return {path for folder in folders for path in matching(glob.escape(folder) + (after[0] or "/*"))}


def _paths(sequence, suite_folder, inputs, program):
    """The paths that a line of the suite stands for."""
    if is_url(sequence.pattern):
        return [download(sequence.pattern, inputs / "downloads")]
    pattern = os.path.join(suite_folder, os.path.expanduser(sequence.pattern))
    if os.path.exists(pattern):
        return [_checked(sequence, os.path.normpath(pattern))]
    if dataset := DATASET_NAME.fullmatch(sequence.pattern):
        return [fetch_by_name(sequence.pattern, program, inputs / "downloads" / dataset[1])]
    found = sorted(path for path in matching(pattern) if kind_of(path) != "nothing")
    if not found:
        raise BatchError(f"{sequence.where}: {sequence.pattern}: no such recording (looked for {os.path.normpath(pattern)})")
    return [_checked(sequence, os.path.normpath(path)) for path in found]


def _checked(sequence, path):
    if kind_of(path) not in ("file", "folder"):
        raise BatchError(f"{sequence.where}: {path}: is a {kind_of(path)}; give the folder or the file of a recording")
    return Path(path)


def _camera(sequence, suite_folder):
    """The argument of --camera and what of it goes into the key."""
    path = os.path.join(suite_folder, sequence.camera)
    if sequence.camera and os.path.isfile(path):
        return os.path.normpath(path), hash_of_file(path)
    return sequence.camera, sequence.camera  # a name such as freiburg1; `kinloop run` knows which there are


def find_recordings(suite, inputs, program):
    """Returns the recordings of a suite, in its order; `program` fetches those of datasets and knows their cameras. Throws
    BatchError if one is missing or two share a name."""
    hashes, recordings = Hashes(Path(inputs) / "hashes"), []
    for sequence in suite.sequences:
        camera, camera_identity = _camera(sequence, suite.folder)
        truth = os.path.normpath(os.path.join(suite.folder, sequence.truth)) if sequence.truth else ""
        if os.path.exists(truth):
            _checked(sequence, truth)
        for path in [sequence.pattern] if is_simulated(sequence.pattern) else _paths(sequence, suite.folder, Path(inputs), program):
            if is_simulated(sequence.pattern):
                name, dataset, identity, pixels = path, "simulated", {"simulated": path, "camera": ""}, 0.0
            else:
                digest, files = hashes.of(path)
                _check_hash(sequence, path, digest)
                pixels = pixels_of_files(files)
                # The name of a folder may tell the camera (rgbd_dataset_freiburg1_room).
                name, dataset = path.name, path.parent.name
                identity = {"name": path.name, "sha256": digest, "camera": "" if camera else camera_of(path, program)}
            if camera:
                identity["camera"] = camera_identity
            if truth:
                identity["truth"] = hashes.of(truth)[0] if os.path.exists(truth) else ""
            recordings.append(Recording(sequence.name or name, sequence.dataset or dataset, str(path), camera, truth, identity, pixels))
    _check_names(recordings)
    return recordings


def _check_hash(sequence, path, digest):
    if sequence.sha256 and sequence.sha256 != digest:
        raise BatchError(f"{sequence.where}: {path}: is another recording than the suite means: its sha256 is {digest}; "
                         "copy or fetch it again, or correct the suite")  # fmt: skip


def _check_names(recordings):
    seen = {}
    for recording in recordings:
        if recording.name in seen:
            raise BatchError(f"two sequences are named {recording.name}: {seen[recording.name]} and {recording.path}; "
                             "give one a 'name:'")  # fmt: skip
        seen[recording.name] = recording.path
