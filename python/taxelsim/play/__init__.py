"""A playground in the browser: an object that the mouse presses into a sensor. Needs the package viser."""

from .playground import Playground

__all__ = ["Playground"]
