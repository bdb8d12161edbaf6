#include "cli/usage_error.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <string_view>

#include "base/text.h"

namespace taxelsim::cli {
namespace {

bool isNumber(const std::string& word) {
  double number = 0;
  return parseNumber(word, number);
}

// A negative number is a value.
bool isOption(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && (word[1] == '-' || std::isalpha(static_cast<unsigned char>(word[1])) != 0);
}

// "--load" of "--load=5", "-o" of "-out.png".
std::string nameOf(const std::string& option) {
  return option[1] == '-' ? option.substr(0, option.find('=')) : option.substr(0, 2);
}

std::vector<std::string> subcommandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// Options of the subcommand, if any, and of the program, which are allowed everywhere.
class Options {
 public:
  Options(const CLI::App& app, const CLI::App* command) : scopes_{&app} {
    if (command != nullptr) scopes_.insert(scopes_.begin(), command);
  }

  const CLI::Option* find(const std::string& name) const {
    for (const CLI::App* scope : scopes_) {
      if (const CLI::Option* option = scope->get_option_no_throw(name)) return option;
    }
    return nullptr;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const CLI::App* scope : scopes_) {
      for (const CLI::Option* option : scope->get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      }
    }
    return names;
  }

 private:
  std::vector<const CLI::App*> scopes_;
};

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = nearestWord(word, candidates);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

std::string unknownSubcommand(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = suggestion(word, known);
  return fmt::format("unknown subcommand '{}'{}", oneLine(word),
                     nearest.empty() ? fmt::format("; there are {}", fmt::join(known, ", ")) : nearest);
}

// Numbers that follow the value of an option, which takes one argument: the quotes are missing. Empty if there are none.
std::string missingQuotes(const std::string& option, const std::vector<std::string>& words, std::size_t first) {
  const auto begin = words.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = std::find_if_not(begin, words.end(), isNumber);
  if (end - begin < 2) return "";
  const std::string numbers = fmt::format("{}", fmt::join(begin, end, " "));
  return fmt::format("{} {}: these numbers are one argument and need quotes: {} \"{}\"", option, numbers, option, numbers);
}

// CLI11 writes "Could not convert: --load = 5N". All options that are converted are numbers.
std::string conversionMessage(const CLI::ConversionError& error) {
  constexpr std::string_view kPrefix = "Could not convert: ", kEquals = " = ";
  std::string text = error.what();
  const std::size_t equals = text.find(kEquals);
  if (!text.starts_with(kPrefix) || equals == std::string::npos) return text;
  return text.substr(kPrefix.size(), equals - kPrefix.size()) + ": " + text.substr(equals + kEquals.size()) + " is not a number";
}

}  // namespace

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t least = 1 + std::max<std::size_t>(1, word.size() / 3);
  for (const std::string& candidate : candidates) {
    const std::size_t distance = editDistance(word, candidate);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string usageMessage(const CLI::App& app, const std::vector<std::string>& words, const CLI::ParseError& error) {
  const bool has_extra_words = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const CLI::App* command = nullptr;
  for (std::size_t w = 0; w < words.size(); ++w) {
    const std::string& word = words[w];
    if (word == "--") break;
    if (!isOption(word)) {
      if (command != nullptr) continue;
      const std::vector<const CLI::App*> found = app.get_subcommands([&](const CLI::App* known) { return known->get_name() == word; });
      if (found.empty()) return unknownSubcommand(word, subcommandsOf(app));
      command = found.front();
      continue;
    }
    const Options options(app, command);
    const std::string name = nameOf(word);
    const CLI::Option* option = options.find(name);
    if (option == nullptr) return fmt::format("unknown option {}{}", oneLine(name), suggestion(name, options.names()));
    if (option->get_items_expected_max() == 0 || name != word) continue;
    if (std::string message = missingQuotes(name, words, w + 1); has_extra_words && !message.empty()) return message;
    ++w;  // its value
  }
  if (command == nullptr) return fmt::format("a subcommand is required: {}", fmt::join(subcommandsOf(app), ", "));
  if (const auto* conversion = dynamic_cast<const CLI::ConversionError*>(&error)) return conversionMessage(*conversion);
  return error.what();
}

}  // namespace taxelsim::cli
