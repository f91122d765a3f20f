"""What the object of a method has to say besides its signals."""

from __future__ import annotations

from typing import Any


class Notes:
    """Collects the texts of an object's `reports()`, each one once; most objects have no such method.

    `reports() -> tuple[str, ...]` gives all that is worth knowing about the run so far (a wheel has left the ground,
    commands were refused). It is asked after every step. A new object begins anew.
    """

    def __init__(self) -> None:
        self._object: Any = None
        self._said: set[str] = set()

    def new(self, of: Any) -> list[str]:
        """The texts that the object has not given before."""
        if of is not self._object:
            self._object, self._said = of, set()
        reports = getattr(of, "reports", None)
        if reports is None:
            return []
        texts = [text for text in reports() if text not in self._said]
        self._said.update(texts)
        return texts
