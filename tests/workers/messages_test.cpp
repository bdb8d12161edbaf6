#include "workers/messages.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "taxelsim/progress.h"
#include "workers/pipe.h"

namespace taxelsim::testing {
namespace {

using namespace workers;

TEST(Messages, ArriveAsTheyWereSent) {
  Pipe pipe = makePipe();
  const std::vector<Progress> progress{{.episodes_done = 7, .seconds = 0.5}};
  const std::vector<double> many(100'000, 1.5);  // more than a pipe holds
  std::thread sender([&] {
    send(pipe.write.number(), MessageKind::kProgress, std::as_bytes(std::span(progress)));
    send(pipe.write.number(), MessageKind::kVerdicts, std::as_bytes(std::span(many)));
    send(pipe.write.number(), MessageKind::kEnd, {});
    pipe.write.close();
  });
  const auto first = receive(pipe.read.number()), second = receive(pipe.read.number()), third = receive(pipe.read.number());
  sender.join();
  ASSERT_TRUE(first && second && third);
  EXPECT_EQ(first->kind, MessageKind::kProgress);
  EXPECT_EQ(first->values<Progress>().at(0).episodes_done, 7u);
  EXPECT_EQ(second->values<double>(), many);
  EXPECT_EQ(third->kind, MessageKind::kEnd);
  EXPECT_TRUE(third->bytes.empty());
  EXPECT_FALSE(receive(pipe.read.number())) << "the end of the stream";
}

TEST(Messages, ThatAreCutAreNone) {
  Pipe whole = makePipe();
  const std::string text = "a message";
  send(whole.write.number(), MessageKind::kProblem, std::as_bytes(std::span(text)));
  whole.write.close();
  std::string bytes(100, '\0');
  bytes.resize(static_cast<std::size_t>(::read(whole.read.number(), bytes.data(), bytes.size())));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    Pipe cut = makePipe();
    ASSERT_EQ(::write(cut.write.number(), bytes.data(), length), static_cast<ssize_t>(length));
    cut.write.close();
    EXPECT_FALSE(receive(cut.read.number())) << length;
  }
}

}  // namespace
}  // namespace taxelsim::testing
