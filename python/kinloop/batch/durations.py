"""How long runs are expected to take, so that the longest start first and none is left for the end.

In: recordings, options, and the table of earlier results in the same folder. Out: CPU seconds of a run. They decide the
order of runs only, never a result."""

import math
import struct

from .statistics import grouped, median
from .tables import read_rows

# CPU times measured on redkitchen (640 x 480) and on sim:room at 160 x 120 and 640 x 480.
START_S = 0.2
READ_S_PER_PIXEL = 1.2e-8  # decoding of both images
MAP_S_PER_PIXEL = 1.2e-8
SIMULATED_S_PER_FRAME = 0.035
SIMULATED_S_PER_PIXEL = 6e-7
BYTES_PER_PIXEL = 1.5  # of a recording in one file, colour and depth together
IMAGES = (".png", ".jpg", ".jpeg", ".ppm", ".pgm", ".tif", ".tiff")
DEFAULT_PIXELS = 640 * 480
SIMULATED_FRAMES = 560  # of the whole built-in path
MAX_HEADER_BYTES = 1 << 16


def image_pixels(path):
    """Width times height of a PNG or JPEG image by its header; None for others."""
    with open(path, "rb") as file:
        data = file.read(MAX_HEADER_BYTES)
    if data[:8] == b"\x89PNG\r\n\x1a\n" and len(data) >= 24:
        width, height = struct.unpack_from(">II", data, 16)
        return width * height
    return _jpeg_pixels(data) if data[:2] == b"\xff\xd8" else None


def _jpeg_pixels(data):
    place = 2
    while place + 9 <= len(data) and data[place] == 0xFF:
        if 0xC0 <= data[place + 1] <= 0xCF and data[place + 1] not in (0xC4, 0xC8, 0xCC):  # start of frame
            height, width = struct.unpack_from(">HH", data, place + 5)
            return width * height
        place += 2 + struct.unpack_from(">H", data, place + 2)[0]
    return None


def pixels_of_files(files):
    """Frames times pixels of a recording. `files`: (path, size in bytes) of all its files."""
    images = [path for path, _ in files if str(path).lower().endswith(IMAGES)]
    if len(images) < 2:  # a bag, or another recording in one file
        return sum(size for _, size in files) / BYTES_PER_PIXEL
    # Colour images may be larger than depth images; half of all are of each kind.
    sizes = [image_pixels(images[i]) or DEFAULT_PIXELS for i in (0, -1)]
    return len(images) / 2 * max(sizes)


def _number(options, name):
    try:
        value = float(options.get(name, 0))
    except ValueError:
        value = 0.0  # a wrong option; the run will say so
    return value if math.isfinite(value) else 0.0


def _of_simulation(options):
    frames = _number(options, "sim.frames") or (_number(options, "sim.seconds") * (_number(options, "sim.fps") or 30)) or SIMULATED_FRAMES
    width, height = _number(options, "sim.width"), _number(options, "sim.height")
    pixels = width * height or (width or 4 / 3 * height) ** 2 * 3 / 4 or DEFAULT_PIXELS
    return frames * (SIMULATED_S_PER_FRAME + SIMULATED_S_PER_PIXEL * pixels)


def by_size(recording, options, every):
    """CPU seconds of a run by frames and pixels. `every`: frames that are left out are read nevertheless."""
    if recording.path.startswith("sim:"):
        return START_S + _of_simulation(options)
    return START_S + recording.pixels * (READ_S_PER_PIXEL + MAP_S_PER_PIXEL / every)


class Durations:
    """Expected CPU seconds: those of the same sequence and variant in an earlier table, else of the same sequence with any
    variant, else by size, scaled to what is known of others."""

    def __init__(self, rows=()):
        known = [row for row in rows if row["cpu_s"]]
        self._of_variant = self._medians(known, "dataset", "sequence", "variant")
        self._of_sequence = self._medians(known, "dataset", "sequence")

    @staticmethod
    def _medians(rows, *names):
        return {key: median(row["cpu_s"] for row in group) for key, group in grouped(rows, *names).items()}

    @classmethod
    def of_results(cls, store):
        """From the table of a folder of results; knows nothing if there is none yet."""
        try:
            return cls(read_rows(store.folder / "runs.csv"))
        except (OSError, ValueError, KeyError):
            return cls()

    def set_expected(self, jobs):
        """Corrects `expected_s` of jobs, which is by size, where more is known."""
        measured = {id(job): self._measured(job) for job in jobs}
        ratios = [measured[id(job)] / job.expected_s for job in jobs if measured[id(job)]]
        scale = median(ratios) or 1.0
        for job in jobs:
            job.expected_s = round(measured[id(job)] or scale * job.expected_s, 3)

    def _measured(self, job):
        sequence = (job.dataset, job.sequence)
        return self._of_variant.get((*sequence, job.variant)) or self._of_sequence.get(sequence)
