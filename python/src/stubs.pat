# Removes what type checkers refuse: the value None of the method __hash__.
\.__hash__$:
