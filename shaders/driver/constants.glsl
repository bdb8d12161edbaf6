// Logical operations in constants from which others follow. Mesa 22.3 builds no pipeline with "||" or "&&" in such an expression.
#define EITHER(a, b) ((uint(a) | uint(b)) != 0u)
#define BOTH(a, b) ((uint(a) & uint(b)) != 0u)
