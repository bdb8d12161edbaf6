// Detects loops that a driver has ended early: Mesa's lavapipe ends all loops of an invocation, silently, after 65,535 iterations in total.
//
// Loops with long bodies test at their end, with the same rounds in all invocations: docs/decisions/0024-loops-that-test-at-their-end.md. A
// loop whose length depends on the scene calls checkLoop() behind it with its own condition. The host turns problems[0] != 0 into an error.
// Mutable globals: any_unfinished_loop, one flag per invocation; num_iterations, the same in all invocations of a workgroup.

bool any_unfinished_loop = false;

void checkLoop(bool unfinished) { any_unfinished_loop = any_unfinished_loop || unfinished; }

// Iterations that an invocation has taken so far, of the loops whose length depends most on the pose, estimated as by the host.
uint num_iterations = 0;

// Counts iterations that all invocations of a workgroup share.
void countIterations(uint together) { num_iterations += together / WORKGROUP + 1u; }

void reportUnfinishedLoops() {
  if (any_unfinished_loop) problems[0] = 1;
}
