"""ROS 2 without an installation of ROS (docs/how_to/ros2.md). The module `bridge` needs the package cyclonedds; `topics` needs none."""
