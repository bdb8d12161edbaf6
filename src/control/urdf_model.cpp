#include "control/urdf_model.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
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

constexpr std::size_t kMaxLinks = 4096;  // links hold their children, which are let go of one within the other
constexpr std::size_t kMaxShown = 80;    // bytes of a name that a message repeats
constexpr const char* kJointTypes[] = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};

std::string textOf(const XMLElement& element, const char* attribute) {
  const char* const text = element.Attribute(attribute);
  return text == nullptr ? std::string() : std::string(text).substr(0, kMaxShown);
}

// Takes what urdfdom would print, for as long as it lives. console_bridge has one handler for the whole program, so one thread at a time.
class CaughtMessages : public console_bridge::OutputHandler {
 public:
  CaughtMessages() : lock_(mutex()), level_(console_bridge::getLogLevel()) {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~CaughtMessages() override {
    console_bridge::setLogLevel(level_);
    console_bridge::restorePreviousOutputHandler();
  }
  CaughtMessages(const CaughtMessages&) = delete;
  CaughtMessages& operator=(const CaughtMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override {
    if (first_.empty()) first_ = text;
  }
  // What went wrong first: what follows are its consequences.
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

// The file while it is XML: is it well-formed, and a tree? urdfdom finds neither loops nor links with two parents, and reads XML by
// recursion.
class UrdfText {
 public:
  explicit UrdfText(const std::filesystem::path& file) : file_(file, kMaxRobotFileBytes), robot_(file_.root()) {
    if (robot_ == nullptr || std::string_view(robot_->Name()) != "robot") fail(1, "is not a URDF: no <robot>");
    check();
  }

  // Links and joints alone: what a robot looks like and weighs does not matter here, and need not be right.
  std::string kinematics() const;

 private:
  struct Parent {
    const XMLElement* joint;
    std::string link;
  };

  [[noreturn]] void fail(int line, const std::string& what) const { file_.fail(line, what); }
  void check() const;
  void checkLoops(const std::map<std::string, Parent>& parents) const;

  XmlFile file_;
  const XMLElement* robot_;
};

std::string UrdfText::kinematics() const {
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

void UrdfText::check() const {
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
      fail(joint->GetLineNum(), joint_name + ": its child " + std::string(child_link).substr(0, kMaxShown) + " already hangs on joint " +
                                    textOf(*place->second.joint, "name") + ": one parent a link");
    }
  }
  checkLoops(parents);
}

void UrdfText::checkLoops(const std::map<std::string, Parent>& parents) const {
  std::map<std::string, const XMLElement*> seen;  // by link: the joint whose way up came by
  for (const auto& [link, parent] : parents) {
    const std::string* at = &link;
    for (auto next = parents.find(*at); next != parents.end(); next = parents.find(*at)) {
      const auto [place, is_new] = seen.emplace(*at, parent.joint);
      if (!is_new && place->second == parent.joint)
        fail(parent.joint->GetLineNum(),
             "joint " + textOf(*parent.joint, "name") + " is part of, or hangs on, a loop of links: a tree is allowed");
      if (!is_new) break;
      at = &next->second.link;
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
  std::vector<const urdf::Link*> open{model.getRoot().get()};
  while (!open.empty()) {
    const urdf::Link& link = *open.back();
    open.pop_back();
    for (const urdf::LinkSharedPtr& child : link.child_links) {
      tree.addSegment(segmentOf(*child->parent_joint), link.name);
      open.push_back(child.get());
    }
  }
  return tree;
}

}  // namespace

UrdfModel::UrdfModel(const std::filesystem::path& file) : name_(file.generic_string()) {
  const std::string text = UrdfText(file).kinematics();
  std::string problem;
  {
    const CaughtMessages messages;
    try {
      model_ = urdf::parseURDF(text);
    } catch (const std::exception& error) {
      problem = error.what();
    }
    if (problem.empty()) problem = messages.first();
  }
  if (!model_ || !model_->getRoot()) fail(problem.empty() ? "is not a URDF" : problem);
  tree_ = treeOf(*model_);
}

void UrdfModel::fail(const std::string& what) const {
  throw Error(ErrorKind::kInput, oneLine(name_ + ": " + what));
}

}  // namespace taxelsim
