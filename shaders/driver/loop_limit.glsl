// Detects loops that a driver has ended early: Mesa's lavapipe ends all loops of an invocation, silently, after 65,535 iterations in total.
//
// A loop whose length depends on the scene calls checkLoop() behind it with its own condition. The host turns problems[0] != 0 into an error.
// Mutable global: any_unfinished_loop, one flag per invocation.

bool any_unfinished_loop = false;

void checkLoop(bool unfinished) { any_unfinished_loop = any_unfinished_loop || unfinished; }

void reportUnfinishedLoops() {
  if (any_unfinished_loop) problems[0] = 1;
}
