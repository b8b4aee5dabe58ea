"""The line that says how far a batch is and how long it will take."""

import sys
import time

from .text import printable

PLAIN_INTERVAL_S = 30.0
TERMINAL_INTERVAL_S = 0.5
SHORTEST_S = 1e-3


def duration(seconds):
    seconds = round(seconds)
    if seconds < 60:
        return f"{seconds} s"
    if seconds < 3600:
        return f"{seconds // 60} min {seconds % 60:02} s"
    return f"{seconds // 3600} h {seconds % 3600 // 60:02} min"


class Progress:
    """Counts finished runs. A terminal has one line that changes; a file gets a line every half a minute. The longest runs
    are done first, so the time left is that of the work that is expected, not of the number of runs."""

    def __init__(self, jobs, quiet, stream=None):
        self.total, self.done, self.quiet = len(jobs), 0, quiet
        self.left_s = {job.key: max(job.expected_s, SHORTEST_S) for job in jobs}
        self.expected_s = sum(self.left_s.values())
        self.stream = stream or sys.stderr
        self.terminal = self.stream.isatty()
        self.begin = self.last = time.monotonic()
        self.noted = ""

    def finish_one(self, key):
        self.done += 1
        self.left_s.pop(key, None)
        self.show()

    def show(self):
        time_ = time.monotonic()
        interval = TERMINAL_INTERVAL_S if self.terminal else PLAIN_INTERVAL_S
        if self.quiet or not (self.done == self.total or time_ - self.last >= interval):
            return
        self.last = time_
        text = f"{self.done}/{self.total} runs"
        if self.done < self.total:
            left_s = sum(self.left_s.values())
            text += f", {duration((time_ - self.begin) * left_s / max(self.expected_s - left_s, SHORTEST_S))} left"
        end = "\n" if not self.terminal or self.done == self.total else ""
        print(f"\r\x1b[K{text}" if self.terminal else text, end=end, file=self.stream, flush=True)

    def note(self, text):
        """Prints a line of text, once."""
        if text != self.noted and not self.quiet:
            self.end_line()
            print(printable(text), file=self.stream, flush=True)
        self.noted = text

    def end_line(self):
        if self.terminal and not self.quiet and self.done < self.total:
            print(file=self.stream)
