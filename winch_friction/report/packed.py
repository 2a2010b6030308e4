"""Scripts packed for a page, kept on disk: to pack four megabytes anew takes 0.15 s of every report."""

import base64
import gzip
import hashlib

from winch_friction.physics.friction.sources import cache_root, keep, read_kept


def packed(source: bytes) -> str:
    """Gzipped and in base64."""
    try:
        path = cache_root("packed") / hashlib.sha256(source).hexdigest()
        text = read_kept(path)
        if text is None:
            text = _packed(source)
            path.parent.mkdir(parents=True, exist_ok=True)
            keep(path, text)
        return text
    except OSError:  # nowhere to keep it
        return _packed(source)


def _packed(source: bytes) -> str:
    return base64.b64encode(gzip.compress(source, 9, mtime=0)).decode()
