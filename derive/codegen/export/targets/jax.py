"""JAX: functions that can be compiled, differentiated and vectorised."""

from derive.codegen.export.python_syntax import PythonFunctions, functions_of


class Jax(PythonFunctions):
    """Functions of arrays, whose results are arrays."""

    title, suffix, command = "JAX", "_jax.py", ""
    arithmetic = "XLA may fuse and reorder operations, so that last bits differ from other targets."
    imports = """
import jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)"""
    collected = "return jnp.stack([jnp.asarray(one, dtype=float) for one in result])"
    functions = functions_of(
        "jnp",
        "sqrt sin cos tan exp log sinh cosh tanh",
        atan="jnp.arctan",
        atan2="jnp.arctan2",
        pow="jnp.power",
        abs="jnp.abs",
        select="jnp.where({0} > 0.0, {1}, jnp.where({0} <= 0.0, {2}, {0}))",
    )


target = Jax
