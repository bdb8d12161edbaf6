// Loads the kinematics of a URDF file: validated XML, parsed by urdfdom, converted to a KDL tree. urdf_robot.cpp builds a
// Manipulator from it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace urdf {
class ModelInterface;
}
namespace KDL {
class Tree;
}

namespace taxelsim {

class UrdfModel {
 public:
  // Throws Error(kInput), one line that starts with the file's name, for a file that is missing, malformed, or not a tree of links. Reads
  // links and joints only.
  explicit UrdfModel(const std::filesystem::path& file);
  ~UrdfModel();
  UrdfModel(const UrdfModel&) = delete;
  UrdfModel& operator=(const UrdfModel&) = delete;

  // Throws Error(kInput), "file: message".
  [[noreturn]] void fail(const std::string& message) const;

  const urdf::ModelInterface& urdf() const { return *model_; }

  // Each link except the root is a segment of the same name. Floating and planar joints, which KDL lacks, are fixed. Mimic
  // joints are independent.
  const KDL::Tree& tree() const { return *tree_; }

 private:
  std::string name_;
  std::shared_ptr<urdf::ModelInterface> model_;
  std::unique_ptr<KDL::Tree> tree_;
};

}  // namespace taxelsim
