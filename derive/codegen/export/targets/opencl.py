"""OpenCL C: functions, and a kernel that integrates many motions, on any device with doubles."""

from derive.codegen.export.targets.c99 import C99

KERNEL = """\
/* Integrate one motion a work item, in `steps` equal steps of size h from t = 0; states and
   parameters of a motion follow each other. */
__kernel void integrate(__global const double *starts, __global const double *params,
        __global double *ends, const int steps, const double h)
{{
    const size_t motion = get_global_id(0);
    double y[SIZE], next[SIZE], own[{parameters}], derivatives[SIZE*STAGES];
    for (int n = 0; n < SIZE; n++) {{
        y[n] = starts[motion*SIZE + n];
    }}
    for (int n = 0; n < {parameters}; n++) {{
        own[n] = params[motion*{parameters} + n];
    }}
    for (int k = 0; k < steps; k++) {{
        step(h*k, h, y, own, derivatives, next);
        for (int n = 0; n < SIZE; n++) {{
            y[n] = next[n];
        }}
    }}
    for (int n = 0; n < SIZE; n++) {{
        ends[motion*SIZE + n] = y[n];
    }}
}}
"""


class OpenCL(C99):
    """The functions of C99, whose constants are those of the device."""

    title, suffix, library_suffix = "OpenCL C", ".cl", ".cl"
    command, is_program, has_fixed_steps = "", False, True
    arithmetic = "Arithmetic is that of IEEE 754; products and sums are not fused."
    qualifiers = "inline"
    reserved = f"{C99.reserved} kernel global local constant half vec_step"
    real = "__constant double {name} = {value};"
    table = ("__constant double {name}[{size}] = {{", "}};")

    def head(self) -> str:
        return "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n#pragma OPENCL FP_CONTRACT OFF\n"

    def tail(self) -> str:
        has_steps = "step" in self.program.routines
        return KERNEL.format(parameters=len(self.exported.values)) if has_steps else ""


target = OpenCL
