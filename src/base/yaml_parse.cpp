#include "base/yaml_parse.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <string_view>

#include "base/byte_order_mark.h"
#include "base/files.h"
#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::int64_t kMaxOpenBrackets = 1 << 16;  // far more than kMaxYamlDepth, as comments may have some

[[noreturn]] void failAt(const std::string& file, int line, int column, const std::string& message) {
  throw Error(ErrorKind::kInput, oneLine(file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + message));
}

// Refuses control characters, invalid UTF-8 and tabs with a clear message; yaml-cpp accepts them. Refuses brackets that are never closed,
// of which yaml-cpp keeps every one, 230 bytes each, until the end of the text.
void checkCharacters(std::string_view text, const std::string& file) {
  int line = 1;
  int column = 1;
  bool indentation = true;
  std::int64_t open_brackets = 0;  // also those in quotes and comments
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t length = utf8Length(text, i);
    if (length == 0) failAt(file, line, column, "not a YAML file: the text is not UTF-8");
    if (c == '\t' && indentation) failAt(file, line, column, "a tab before the text of a line: indent with spaces");
    if ((c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7F) {
      failAt(file, line, column, "not a YAML file: control character " + std::to_string(c));
    }
    if (c == '[' || c == '{') ++open_brackets;
    if ((c == ']' || c == '}') && open_brackets > 0) --open_brackets;
    if (open_brackets > kMaxOpenBrackets) {
      failAt(file, line, column,
             "more than " + std::to_string(kMaxOpenBrackets) + " brackets are open: nested deeper than " + std::to_string(kMaxYamlDepth) +
                 " levels");
    }
    if (c == '\n') {
      ++line;
      column = 1;
      indentation = true;
    } else {
      column += static_cast<int>(length);
      indentation = indentation && c == ' ';
    }
    i += length;
  }
}

// Builds the tree from yaml-cpp's events. Events precede the recursion of yaml-cpp, so the depth limit also bounds that recursion.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& file, std::size_t max_nodes) : file_(file), max_nodes_(max_nodes) {}

  YamlTree takeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++num_documents_ > 1) fail(mark, "a second document, or text after the first: one document a file");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(make(mark, "", anchor, YamlTree::Kind::kNull)); }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    fail(mark, "an alias (*name) is not allowed: write the value out");
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
    YamlTree scalar = make(mark, tag, anchor, YamlTree::Kind::kScalar);
    scalar.text = value;
    scalar.quoted = tag == "!";
    add(std::move(scalar));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open(make(mark, tag, anchor, YamlTree::Kind::kSequence), mark);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open(make(mark, tag, anchor, YamlTree::Kind::kMap), mark);
  }
  void OnMapEnd() override {
    checkDuplicates(open_.back());
    close();
  }

 private:
  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& message) const {
    failAt(file_, mark.line + 1, mark.column + 1, message);
  }

  YamlTree make(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlTree::Kind kind) {
    if (anchor != 0) fail(mark, "an anchor (&name) is not allowed: write the value out where it is needed");
    if (!tag.empty() && tag != "?" && tag != "!") fail(mark, "a tag (" + tag.substr(0, 40) + ") is not allowed");
    if (++num_nodes_ > max_nodes_) fail(mark, "more than " + std::to_string(max_nodes_) + " values in one file");
    YamlTree tree;
    tree.kind = kind;
    tree.line = mark.line + 1;
    tree.column = mark.column + 1;
    return tree;
  }

  bool wantsKey() const {
    return !open_.empty() && open_.back().kind == YamlTree::Kind::kMap && open_.back().keys.size() == open_.back().children.size();
  }

  void open(YamlTree tree, const YAML::Mark& mark) {
    if (wantsKey()) fail(mark, "a key must be a word");
    if (open_.size() >= kMaxYamlDepth) fail(mark, "nested deeper than " + std::to_string(kMaxYamlDepth) + " levels");
    open_.push_back(std::move(tree));
  }

  void close() {
    YamlTree tree = std::move(open_.back());
    open_.pop_back();
    add(std::move(tree));
  }

  void add(YamlTree tree) {
    if (open_.empty()) {
      root_ = std::move(tree);
    } else if (wantsKey()) {
      if (tree.kind != YamlTree::Kind::kScalar) failAt(file_, tree.line, tree.column, "a key must be a word");
      open_.back().keys.push_back({std::move(tree.text), tree.line, tree.column});
    } else {
      YamlTree& parent = open_.back();
      if (tree.kind == YamlTree::Kind::kNull && parent.kind == YamlTree::Kind::kMap) {
        // yaml-cpp gives a missing value the position of the next token.
        tree.line = parent.keys.back().line;
        tree.column = parent.keys.back().column;
      }
      parent.children.push_back(std::move(tree));
    }
  }

  void checkDuplicates(const YamlTree& map) const {
    std::vector<std::size_t> order(map.keys.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return map.keys[a].text < map.keys[b].text; });
    for (std::size_t i = 1; i < order.size(); ++i) {
      const YamlTree::Key& first = map.keys[order[i - 1]];
      const YamlTree::Key& second = map.keys[order[i]];
      if (first.text == second.text) {
        failAt(file_, second.line, second.column,
               "duplicate key '" + second.text.substr(0, 40) + "': already given on line " + std::to_string(first.line));
      }
    }
  }

  const std::string& file_;
  std::size_t max_nodes_;
  YamlTree root_;
  std::vector<YamlTree> open_;
  std::size_t num_nodes_ = 0;
  int num_documents_ = 0;
};

}  // namespace

std::string readYamlFile(const std::filesystem::path& file) {
  return readTextFile(file, kMaxYamlBytes);
}

YamlTree parseYaml(std::string text, const std::string& file, std::size_t max_nodes) {
  text.erase(0, text.size() - withoutByteOrderMark(text).size());
  checkCharacters(text, file);
  TreeBuilder builder(file, max_nodes);
  try {
    std::istringstream stream(std::move(text));
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) failAt(file, 1, 1, "the file is empty");
    parser.HandleNextDocument(builder);
  } catch (const YAML::Exception& exception) {
    failAt(file, std::max(exception.mark.line, 0) + 1, std::max(exception.mark.column, 0) + 1, "not YAML: " + exception.msg);
  }
  return builder.takeRoot();
}

}  // namespace taxelsim
