// Loops in the form that software drivers run fast, and the detection of loops that a driver has ended early: Mesa's lavapipe ends all
// loops of an invocation, silently, after 65,535 iterations in total.
//
// Loops with long bodies test at their end, with the same rounds in all invocations:
// docs/notes/decisions/0024-loops-that-test-at-their-end.md. A loop whose length depends on the scene calls checkLoop() behind it with its
// own condition. The host turns problems[0] != 0 into an error.
// Mutable globals: any_unfinished_loop, one flag per invocation; num_iterations, the same in all invocations of a workgroup.
#ifndef DRIVER_LOOPS_GLSL
#define DRIVER_LOOPS_GLSL
bool any_unfinished_loop = false;

void checkLoop(bool unfinished) { any_unfinished_loop = any_unfinished_loop || unfinished; }

// Iterations that an invocation has taken so far, of the loops whose length depends most on the pose, estimated as by the host.
uint num_iterations = 0;

// Counts iterations that all invocations of a workgroup share.
void countIterations(uint together) { num_iterations += together / WORKGROUP + 1u; }

void reportUnfinishedLoops() {
  if (any_unfinished_loop) problems[0] = 1;
}

// Runs `statement` for the items k = 0 to count - 1, which the invocations of the workgroup share.
#define FOR_EACH(count, statement)    \
  {                                   \
    uint k = gl_LocalInvocationIndex; \
    if (k < (count)) do {             \
        statement;                    \
        k += WORKGROUP;               \
      } while (k < (count));          \
    checkLoop(k < (count));           \
  }

// Reduces items to partial sums, driver/workgroup.glsl: for each item k = 0 to count - 1 `statement` updates the vec4 `sums`. Partial
// sum `part` begins at `initial` and takes every LANES-th item; there are num_parts, at most min(LANES, count).
#define REDUCE(num_parts, count, initial, statement)     \
  {                                                      \
    uint part = gl_LocalInvocationIndex;                 \
    if (part < (num_parts)) do {                         \
        vec4 sums = initial;                             \
        uint k = part;                                   \
        do {                                             \
          if (k < (count)) statement;                    \
          k += LANES;                                    \
        } while (k - part < (count));                    \
        checkLoop(k < (count));                          \
        setPartial(part, sums);                          \
        part += WORKGROUP;                               \
      } while (WORKGROUP < LANES && part < (num_parts)); \
  }
#endif
