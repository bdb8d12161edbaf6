// docs/reference/data_set.md has every feature of the feature table, with the same shape, unit, frame and text.
#include "simulation/feature_table.h"
#include "support/test.h"

namespace taxelsim {
namespace {

std::string document() {
  std::ifstream file(TAXELSIM_SOURCE_DIR "/docs/reference/data_set.md");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string shapeText(std::size_t width, std::size_t parts) {
  if (width == 1) return "";
  if (parts == 1) return " (" + std::to_string(width) + ")";
  return width == parts ? " (" + std::to_string(parts) + ")" : " (" + std::to_string(width / parts) + ", " + std::to_string(parts) + ")";
}

template <typename Field>
std::string rowText(const Field& field, std::size_t parts) {
  std::string row = "| `" + std::string(field.name) + "` |" + shapeText(field.width, parts) + " | ";
  for (const std::string_view cell : {field.unit, field.frame}) row += std::string(cell) + " | ";
  return row + field.description("the taxel forces") + (field.recorded == "elastic_layer" ? " Law `elastic_layer` only." : "") + " |\n";
}

// One table of the document: its rows follow each other.
template <typename Field>
void expectTable(const std::string& text, std::span<const Field> fields, std::size_t parts = 1) {
  std::string table = "|---|---|---|---|---|\n";
  for (const Field& field : fields) {
    if (field.recorded != "never") table += rowText(field, parts);
  }
  EXPECT_THAT(text, ::testing::HasSubstr(table + "\n"));
}

TEST(DataSetDocument, HasTheFeatureTable) {
  const std::string text = document();
  expectTable(text, imageFeatures());
  expectTable(text, readoutFeatures());
  expectTable(text, truthFeatures());
  expectTable(text, contactFeatures());
  expectTable(text, regionFeatures());
  expectTable(text, jacobianFeatures(), 6);
  expectTable(text, wrenchJacobian(), 6);
}

}  // namespace
}  // namespace taxelsim
