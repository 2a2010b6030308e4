"""The one way in to pydantic: its first API, which Ubuntu 24.04 (1.10) has and pydantic 2 still ships."""

try:
    from pydantic.v1 import BaseModel, Field, StrictStr, ValidationError, root_validator, validator
    from pydantic.v1.fields import ModelField
except ImportError:  # pydantic 1 itself
    from pydantic import (  # type: ignore
        BaseModel,
        Field,
        StrictStr,
        ValidationError,
        root_validator,
        validator,
    )
    from pydantic.fields import ModelField  # type: ignore

__all__ = ["BaseModel", "Field", "ModelField", "StrictStr", "ValidationError", "root_validator", "validator"]
