// The message of an error that a call must throw.
#pragma once

#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::support {

// Message of the Error(kInput) that `call` throws. The test fails if the call throws nothing, another kind of error, or a message that is
// empty or has more than one line.
template <typename Call>
std::string inputError(Call call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
    const std::string message = error.what();
    EXPECT_FALSE(message.empty());
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace taxelsim::support
