"""The equation book: what a scene's C is made of, typeset from the same symbols."""

from .volume import check_file, list_content, make_book, write_book

__all__ = ["check_file", "list_content", "make_book", "write_book"]
