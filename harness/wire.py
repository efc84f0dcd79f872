"""How a pool and its worker processes talk: pickled frames, each after its length.

A frame is an unsigned 64-bit little-endian length and that many bytes of pickle, protocol 5. A job
is (function, args, kwargs, wants_progress); an answer is ("progress", fraction) any number of times
and then ("result", value) or ("error", exception, traceback text).
"""

from __future__ import annotations

import pickle
import struct
from typing import Any, BinaryIO

HEADER = struct.Struct("<Q")


def pack(message: object) -> bytes:
    """Pickle a message and put its length before it."""
    body = pickle.dumps(message, protocol=5)
    return HEADER.pack(len(body)) + body


def unpack(body: bytes | bytearray) -> Any:
    """Read the message in the body of a frame."""
    return pickle.loads(body)


def read_frame(stream: BinaryIO) -> bytes | None:
    """Read one frame's body from a blocking stream; None at the end of the stream."""
    header = stream.read(HEADER.size)
    if len(header) < HEADER.size:
        return None
    (length,) = HEADER.unpack(header)
    body = stream.read(length)
    return body if len(body) == length else None
