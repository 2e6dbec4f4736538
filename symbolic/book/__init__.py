"""Equation book: the equations of a scene, typeset from the symbols of its C."""

from .volume import check_file, list_content, make_book, write_book

__all__ = ["check_file", "list_content", "make_book", "write_book"]
