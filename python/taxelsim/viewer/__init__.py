"""Data sets and scenes as recordings for the viewer Rerun. Needs the package rerun-sdk."""

from .view import view

__all__ = ["view"]
