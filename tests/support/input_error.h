// The message of an error that a call must throw.
#pragma once

#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::support {

inline const std::string kNoRefusal = "no refusal";

// Message of the Error(kInput) that `call` throws, or kNoRefusal. The test fails for another kind of error, and for a message that is empty
// or has more than one line.
template <typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
    const std::string message = error.what();
    EXPECT_FALSE(message.empty());
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  return kNoRefusal;
}

// The same; the test fails as well if the call throws nothing.
template <typename Call>
std::string inputError(Call call) {
  const std::string message = refusal(call);
  EXPECT_NE(message, kNoRefusal);
  return message;
}

}  // namespace taxelsim::support
