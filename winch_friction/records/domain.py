"""A DDS domain of one's own on this machine: two programs in one domain would talk to each other's nodes."""

import random
import socket

DOMAINS = range(1, 102)  # 0 is everybody's; above 101 a domain's ports are those that the system gives away
# RTPS 2.5, section 9.6.1.1: a domain's ports, and within it two for each participant
FIRST_PORT, PORTS_OF_A_DOMAIN, FIRST_PARTICIPANT = 7400, 250, 10
PARTICIPANTS = 20  # looked for in each domain; a crane's nodes and tools are fewer than ten


def unused_domain() -> int:
    """A domain, drawn at random, that no participant on this machine is in; any one where all are taken."""
    drawn = random.sample(DOMAINS, len(DOMAINS))
    return next((domain for domain in drawn if _is_unused(domain)), drawn[0])


def _is_unused(domain: int) -> bool:
    first = FIRST_PORT + PORTS_OF_A_DOMAIN * domain + FIRST_PARTICIPANT
    return all(_is_free(port) for port in range(first, first + 2 * PARTICIPANTS))


def _is_free(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as tried:
        try:
            tried.bind(("", port))
        except OSError:
            return False
    return True
