// Messages for command lines that do not parse.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace taxelsim::cli {

// The word among `candidates` that `word` is probably a misspelling of; empty if none is near.
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

// Message for a command line that `app` refused with `error`. Names the first wrong word: an unknown subcommand or option, with the nearest
// one that exists, or numbers that need quotes. For any other mistake it is the text of `error`. `words`: the arguments after the
// program's name.
std::string usageMessage(const CLI::App& app, const std::vector<std::string>& words, const CLI::ParseError& error);

}  // namespace taxelsim::cli
