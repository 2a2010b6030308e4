"""What stands first on every page: the decision in a sentence and a few facts, and where it comes from."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from winch_friction.report.tables import paragraph, table_html, words_html


def decision_html(sentence: str, facts: Sequence[tuple[str, str]], after: str = "") -> str:
    """The decision, then facts as (name, value); `after` is HTML below them."""
    cards = "".join(f"<div><dt>{escape(k)}</dt><dd>{escape(v)}</dd></div>" for k, v in facts if v)
    return paragraph(sentence, "verdict") + (f'<dl class="decision">{cards}</dl>' if cards else "") + after


def list_html(lines: Sequence[str], ordered: bool = False) -> str:
    """A list of escaped lines; nothing for none."""
    kind = "ol" if ordered else "ul"
    return f"<{kind}>{''.join(f'<li>{words_html(line)}</li>' for line in lines)}</{kind}>" if lines else ""


def provenance_html(content: Mapping[str, Any]) -> str:
    """Command, version, commit, crane, model, seed and the files with their hashes, as far as they are known."""
    files = content.get("files", {})
    plain = [
        (k.replace("_", " "), _said(v)) for k, v in content.items() if k != "files" and v not in (None, "", [], {})
    ]
    hashes = list(files.items()) if isinstance(files, Mapping) else [(_name(each), _hash(each)) for each in files]
    table = table_html(("what", "value"), plain, "Where this comes from")
    return table + (table_html(("file", "SHA-256"), hashes, "Files") if hashes else "")


def _said(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{k} {v}" for k, v in value.items())
    return ", ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def _name(each: Any) -> str:
    return str(each.get("name", each.get("file", ""))) if isinstance(each, Mapping) else str(each)


def _hash(each: Any) -> str:
    return str(each.get("sha256", "")) if isinstance(each, Mapping) else ""
