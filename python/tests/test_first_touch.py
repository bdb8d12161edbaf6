"""What a new user meets first: one test per trap that somebody fell into, each in the words of that user."""

from __future__ import annotations

# == Every shape pushes back wherever areas are sampled ==

# == Gymnasium's own vector environments take every task ==

# == Counts are integers that torch computes with ==

# == A policy gets every output that it asks for ==

# == Pictures are bright wherever something touches ==

# == Cross-validation compares what can be compared ==

# == evaluate() takes the name of one controller ==

# == observe() refuses the data of another model ==

# == The benchmark page shows a policy that was trained to its end ==

# == Runs that touch nothing say so ==

# == Sizes that look wrong are asked about ==

# == Meshes lie where a new user expects them ==

# == Noise alone is no contact ==

# == Warnings come once, through logging ==

# == Arguments of the wrong kind get one line ==

# == inspect says what it verified ==

# == Typos are found before the program runs ==

# == Documents run as they are printed ==

# == No code of the current folder runs ==

# == Damaged glTF is refused by name ==

# == Hostile data sets and folders ==
