# SPDX-License-Identifier: Apache-2.0
"""Bodies with images."""

from __future__ import annotations

import json
import uuid
from typing import Any, Mapping, Tuple


def content_type_of(image: bytes) -> str:
    """By its first bytes. Raises ValueError for what is neither JPEG nor PNG."""
    if image.startswith(b"\x89PNG"):
        return "image/png"
    if image.startswith(b"\xff\xd8"):
        return "image/jpeg"
    raise ValueError("the image is neither a JPEG nor a PNG file: encode it first")


def multipart(image: bytes, request: Mapping[str, Any]) -> Tuple[bytes, str]:
    """Body and content type of multipart/form-data with the parts `request` and `image` (RFC 7578)."""
    boundary = uuid.uuid4().hex
    parts = (("request", "application/json", json.dumps(request, allow_nan=False).encode()),
             ("image", content_type_of(image), image))
    body = b"".join(
        f'--{boundary}\r\nContent-Disposition: form-data; name="{name}"\r\nContent-Type: {kind}\r\n\r\n'.encode()
        + content + b"\r\n" for name, kind, content in parts)
    return body + f"--{boundary}--\r\n".encode(), f"multipart/form-data; boundary={boundary}"
