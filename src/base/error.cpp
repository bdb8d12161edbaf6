#include "taxelsim/error.h"

#include "base/text.h"

namespace taxelsim {

Error::Error(ErrorKind kind, const std::string& message) : std::runtime_error(messageLine(message)), kind_(kind), reason_(what()) {}

Error::Error(const std::string& field, const std::string& reason)
    : std::runtime_error(messageLine(field + ": " + reason)), kind_(ErrorKind::kInput), field_(field), reason_(messageLine(reason)) {}

}  // namespace taxelsim
