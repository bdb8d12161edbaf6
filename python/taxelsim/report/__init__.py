"""A data set as a page of HTML, and its card in the format of the Hugging Face Hub."""

from .card import card_of
from .page import page_of
from .summary import MAX_FRAMES, Summary, summarize

__all__ = ["MAX_FRAMES", "Summary", "card_of", "page_of", "summarize"]
