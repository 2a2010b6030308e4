"""What runs beside a machine, without ROS: the services that the nodes and the replay share."""
