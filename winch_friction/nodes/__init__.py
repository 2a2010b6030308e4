"""ROS 2 nodes: thin shells that convert, call `step` and publish. The only place that imports rclpy."""
