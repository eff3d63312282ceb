"""The demonstration in data/demo, whole and begun: a whole survey of it takes a test ten seconds."""
import contextlib
import os
import shutil
import struct
import tempfile

DEMO = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", "..", "data", "demo"))


def Ends(log):
    """Where the messages of an LCM log end, from its begin."""
    ends = [0]
    while ends[-1] < len(log):  # a head: sync word, number, time, lengths of channel, data
        _, _, _, channel, size = struct.unpack_from(">IqqII", log, ends[-1])
        ends.append(ends[-1] + 28 + channel + size)
    return ends


def Begin(part=6):
    """The first sixth of its log, or another part."""
    with open(os.path.join(DEMO, "run.lcm"), "rb") as file:
        data = file.read()
    return data[:next(end for end in Ends(data) if end >= len(data) // part)]


@contextlib.contextmanager
def Begun(part=6):
    """A folder of its files, with the begin of its log."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(DEMO, folder, dirs_exist_ok=True)
        with open(os.path.join(folder, "run.lcm"), "wb") as log:
            log.write(Begin(part))
        yield folder
