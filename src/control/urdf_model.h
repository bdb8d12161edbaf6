// The kinematics of a URDF file: parsed by urdfdom, checked, and as a KDL tree. Not yet a robot; urdf_robot.cpp picks the chains.
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <filesystem>
#include <kdl/tree.hpp>
#include <string>

namespace taxelsim {

class UrdfModel {
 public:
  // Throws Error(kInput), one line with the file's name, for what is no tree of links. Only links and joints are read.
  explicit UrdfModel(const std::filesystem::path& file);

  [[noreturn]] void fail(const std::string& what) const;

  const urdf::ModelInterface& urdf() const { return *model_; }

  // Every link but the root is a segment of its own name. Joints that KDL has not (floating, planar) are fixed in it; mimic joints are
  // joints.
  const KDL::Tree& tree() const { return tree_; }

 private:
  std::string name_;
  urdf::ModelInterfaceSharedPtr model_;
  KDL::Tree tree_;
};

}  // namespace taxelsim
