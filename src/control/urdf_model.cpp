#include "control/urdf_model.h"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
#include <kdl/tree.hpp>
#include <map>
#include <mutex>
#include <vector>

#include "base/text.h"
#include "base/xml_file.h"
#include "taxelsim/error.h"
#include "taxelsim/robot.h"

namespace taxelsim {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t kMaxLinks = 4096;     // urdfdom destroys the tree of links recursively: limits the depth of the stack
constexpr std::size_t kMaxNameLength = 80;  // bytes of a name in a message
constexpr const char* kJointTypes[] = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};

std::string textOf(const XMLElement& element, const char* attribute) {
  const char* const text = element.Attribute(attribute);
  return text == nullptr ? std::string() : std::string(text).substr(0, kMaxNameLength);
}

// Captures the messages that urdfdom logs through console_bridge. Its handler is global, so a mutex allows one thread at a time.
class ConsoleCapture : public console_bridge::OutputHandler {
 public:
  ConsoleCapture() : lock_(mutex()), level_(console_bridge::getLogLevel()) {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~ConsoleCapture() override {
    console_bridge::setLogLevel(level_);
    console_bridge::restorePreviousOutputHandler();
  }
  ConsoleCapture(const ConsoleCapture&) = delete;
  ConsoleCapture& operator=(const ConsoleCapture&) = delete;

  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override {
    if (first_.empty()) first_ = text;
  }
  // The first message; later ones are consequences of it.
  const std::string& first() const { return first_; }

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::LogLevel level_;
  std::string first_;
};

// Checks the XML before urdfdom parses it. urdfdom does not detect loops or links with two parents, and parses nested elements recursively.
class UrdfDocument {
 public:
  explicit UrdfDocument(const std::filesystem::path& file) : file_(file, kMaxRobotFileBytes), robot_(file_.root()) {
    if (robot_ == nullptr || std::string_view(robot_->Name()) != "robot") fail(1, "is not a URDF: no <robot>");
    check();
  }

  // The XML reduced to links and joints. Visuals, collision geometry and inertias are dropped and may be invalid.
  std::string kinematics() const;

 private:
  struct Parent {
    const XMLElement* joint;
    std::string link;
  };

  [[noreturn]] void fail(int line, const std::string& message) const { file_.fail(line, message); }
  void check() const;
  void checkLoops(const std::map<std::string, Parent>& parents) const;

  XmlFile file_;
  const XMLElement* robot_;
};

std::string UrdfDocument::kinematics() const {
  tinyxml2::XMLDocument copy;
  XMLElement* const robot = copy.NewElement("robot");
  copy.InsertEndChild(robot);
  const std::string name = textOf(*robot_, "name");
  robot->SetAttribute("name", name.empty() ? "robot" : name.c_str());
  for (const XMLElement* element = robot_->FirstChildElement(); element != nullptr; element = element->NextSiblingElement()) {
    if (std::string_view(element->Name()) == "joint") {
      robot->InsertEndChild(element->DeepClone(&copy));
    } else if (std::string_view(element->Name()) == "link") {
      robot->InsertEndChild(element->ShallowClone(&copy));
    }
  }
  tinyxml2::XMLPrinter printer(nullptr, true);
  copy.Print(&printer);
  return printer.CStr();
}

void UrdfDocument::check() const {
  std::size_t num_links = 0;
  for (const XMLElement* link = robot_->FirstChildElement("link"); link != nullptr; link = link->NextSiblingElement("link")) ++num_links;
  if (num_links > kMaxLinks) fail(1, "has " + std::to_string(num_links) + " links: at most " + std::to_string(kMaxLinks) + " are allowed");

  std::map<std::string, Parent> parents;
  for (const XMLElement* joint = robot_->FirstChildElement("joint"); joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    const std::string joint_name = "joint " + textOf(*joint, "name");
    const std::string type = textOf(*joint, "type");
    if (std::find(std::begin(kJointTypes), std::end(kJointTypes), type) == std::end(kJointTypes)) {
      fail(joint->GetLineNum(), joint_name + ": type: \"" + type +
                                    "\" is not allowed: revolute, continuous, prismatic or fixed (floating and "
                                    "planar where no sensor moves with them)");
    }
    const XMLElement* const child = joint->FirstChildElement("child");
    const XMLElement* const parent = joint->FirstChildElement("parent");
    const char* const child_link = child == nullptr ? nullptr : child->Attribute("link");
    const char* const parent_link = parent == nullptr ? nullptr : parent->Attribute("link");
    if (child_link == nullptr || parent_link == nullptr)
      fail(joint->GetLineNum(), joint_name + ": a <parent link> or <child link> is missing");
    const auto [place, is_new] = parents.emplace(child_link, Parent{joint, parent_link});
    if (!is_new) {
      fail(joint->GetLineNum(), joint_name + ": its child " + std::string(child_link).substr(0, kMaxNameLength) +
                                    " is already the child of joint " + textOf(*place->second.joint, "name") + ": a link has one parent");
    }
  }
  checkLoops(parents);
}

void UrdfDocument::checkLoops(const std::map<std::string, Parent>& parents) const {
  std::map<std::string, const XMLElement*> visited;  // link -> first joint of the path to the root that visited it
  for (const auto& [link, parent] : parents) {
    const std::string* current = &link;
    for (auto next = parents.find(*current); next != parents.end(); next = parents.find(*current)) {
      const auto [place, is_new] = visited.emplace(*current, parent.joint);
      if (!is_new && place->second == parent.joint)
        fail(parent.joint->GetLineNum(),
             "joint " + textOf(*parent.joint, "name") + " is in, or below, a loop of links: only trees are allowed");
      if (!is_new) break;
      current = &next->second.link;
    }
  }
}

KDL::Frame frameOf(const urdf::Pose& pose) {
  const auto [x, y, z, w] = std::array{pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w};
  return {KDL::Rotation::Quaternion(x, y, z, w), KDL::Vector(pose.position.x, pose.position.y, pose.position.z)};
}

KDL::Segment segmentOf(const urdf::Joint& joint) {
  const KDL::Frame F_parent = frameOf(joint.parent_to_joint_origin_transform);
  const KDL::Vector axis = F_parent.M * KDL::Vector(joint.axis.x, joint.axis.y, joint.axis.z);
  KDL::Joint kdl(joint.name, KDL::Joint::Fixed);
  if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS) {
    kdl = KDL::Joint(joint.name, F_parent.p, axis, KDL::Joint::RotAxis);
  } else if (joint.type == urdf::Joint::PRISMATIC) {
    kdl = KDL::Joint(joint.name, F_parent.p, axis, KDL::Joint::TransAxis);
  }
  return KDL::Segment(joint.child_link_name, kdl, F_parent);
}

KDL::Tree treeOf(const urdf::ModelInterface& model) {
  KDL::Tree tree(model.getRoot()->name);
  std::vector<const urdf::Link*> pending{model.getRoot().get()};
  while (!pending.empty()) {
    const urdf::Link& link = *pending.back();
    pending.pop_back();
    for (const urdf::LinkSharedPtr& child : link.child_links) {
      tree.addSegment(segmentOf(*child->parent_joint), link.name);
      pending.push_back(child.get());
    }
  }
  return tree;
}

}  // namespace

UrdfModel::UrdfModel(const std::filesystem::path& file) : name_(file.generic_string()) {
  const std::string text = UrdfDocument(file).kinematics();
  std::string problem;
  {
    const ConsoleCapture capture;
    try {
      model_ = urdf::parseURDF(text);
    } catch (const std::exception& error) {
      problem = error.what();
    }
    if (problem.empty()) problem = capture.first();
  }
  if (!model_ || !model_->getRoot()) fail(problem.empty() ? "is not a URDF" : problem);
  tree_ = std::make_unique<KDL::Tree>(treeOf(*model_));
}

UrdfModel::~UrdfModel() = default;

void UrdfModel::fail(const std::string& message) const {
  throw Error(ErrorKind::kInput, oneLine(name_ + ": " + message));
}

}  // namespace taxelsim
