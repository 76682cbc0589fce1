"""Problems of a book: a file, a line, and a sentence."""
from collections.abc import Sequence


class Problem(Exception):
    """A problem that the author must fix, printed in the format of compilers, so that editors can jump to it."""

    def __init__(self, path: str, line: int, sentence: str) -> None:
        super().__init__(f"{path}:{line}: {sentence}" if line else f"{path}: {sentence}")


class Problems(Exception):
    """Several of them."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        super().__init__("\n".join(map(str, problems)))


def stop_if_any(problems: Sequence[Problem]) -> None:
    if problems:
        raise Problems(problems)
