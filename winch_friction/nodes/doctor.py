"""Whether a node on this machine hears what it says: for `winch-friction doctor`."""

import time
from typing import Any


def seconds_to_hear(longest: float = 5.0) -> float | None:
    """Seconds until a message comes back over the middleware, or None after `longest` s."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from std_msgs.msg import Float64

    context = rclpy.context.Context()
    rclpy.init(context=context)
    try:
        node = rclpy.create_node("winch_friction_doctor", context=context, start_parameter_services=False)
        heard: list[Any] = []
        node.create_subscription(Float64, "~/echo", heard.append, 10)
        publisher = node.create_publisher(Float64, "~/echo", 10)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        begin = time.monotonic()
        while not heard and time.monotonic() - begin < longest:
            publisher.publish(Float64(data=1.0))
            executor.spin_once(timeout_sec=0.05)
        waited = time.monotonic() - begin
        executor.shutdown()
        node.destroy_node()
        return waited if heard else None
    finally:
        rclpy.shutdown(context=context)


def main() -> int:
    """Print the seconds; exit status 1 when nothing was heard."""
    heard = seconds_to_hear()
    print(heard if heard is not None else "nothing")
    return 0 if heard is not None else 1


if __name__ == "__main__":
    raise SystemExit(main())
