"""Short derivations in LaTeX, each in the letters and conventions of another author."""

DOUBLE = r"""
Two bobs, on threads of lengths $a$ and $b$; $\alpha$ and $\beta$ are angles from the vertical.

$$ T = \tfrac12 (M + m) a^2 \dot\alpha^2 + \tfrac12 m b^2 \dot\beta^2
     + m a b \dot\alpha \dot\beta \cos(\alpha - \beta) $$
$$ U = -(M + m) g a \cos\alpha - m g b \cos\beta $$
$$ L = T - U $$
\[ \frac{\partial L}{\partial\dot\alpha} = (M+m) a^2\dot\alpha + m a b\dot\beta\cos(\alpha-\beta) \]
\begin{align}
(M+m) a \ddot\alpha + m b \ddot\beta \cos(\alpha - \beta) + m b \dot\beta^2 \sin(\alpha - \beta)
  + (M + m) g \sin\alpha &= 0, \\
b \ddot\beta + a \ddot\alpha \cos(\alpha-\beta) - a \dot\alpha^2 \sin(\alpha-\beta)
  + g \sin\beta &= 0.
\end{align}
"""

CART = r"""
A cart at $s$ is pushed by $F$; the rod leans by $\varphi$ from the upright.

$$x_b = s - L\sin\varphi, \qquad y_b = L\cos\varphi$$
$$\dot x_b = \dot s - L\dot\varphi\cos\varphi$$
$$(M+m)\ddot s - mL\ddot\varphi\cos\varphi + mL\dot\varphi^2\sin\varphi = F$$
$$L\ddot\varphi - \ddot s\cos\varphi - g\sin\varphi = 0$$
$$\ddot\varphi = \frac{(M+m)g}{ML}\varphi + \frac{F}{ML}$$
"""

SPRING = r"""
The spring has the natural length $d$ and the length $r$:

$$E_k = \frac m2\left(\dot r^2 + r^2\dot\theta^2\right), \quad
  E_p = \frac k2 (r-d)^2 - mgr\cos\theta$$
$$m\ddot r = mr\dot\theta^2 - k(r-d) + mg\cos\theta$$
$$\frac{d}{dt}\left(mr^2\dot\theta\right) = -mgr\sin\theta$$
$$r\ddot\theta + 2\dot r\dot\theta + g\sin\theta = 0$$
"""

ROBOT = r"""
The second angle $q_2$ is measured from the first link.

$$M = \begin{bmatrix} m_1 l_1^2 + m_2 (l_1^2 + 2 l_1 l_2 c_2 + l_2^2) & m_2 (l_1 l_2 c_2 + l_2^2)\\
  m_2 (l_1 l_2 c_2 + l_2^2) & m_2 l_2^2 \end{bmatrix}$$
$$V = -m_1 g l_1 c_1 - m_2 g (l_1 c_1 + l_2 c_{12})$$
$$C = \begin{bmatrix} -m_2 l_1 l_2 s_2 \dot q_2 & -m_2 l_1 l_2 s_2 (\dot q_1 + \dot q_2) \\
  m_2 l_1 l_2 s_2 \dot q_1 & 0 \end{bmatrix}$$
$$G = \begin{bmatrix} (m_1 + m_2) g l_1 s_1 + m_2 g l_2 s_{12} \\ m_2 g l_2 s_{12} \end{bmatrix}$$
$$\frac{\partial V}{\partial q_2} = m_2 g l_2 s_{12}$$
"""

HAMILTON = r"""
$$H = \frac{p_\theta^2}{2 m l^2} + \frac{p_\phi^2}{2 m l^2\sin^2\theta} - m g l\cos\theta$$
$$\dot\theta = \frac{p_\theta}{m l^2}, \qquad \dot\phi = \frac{p_\phi}{m l^2\sin^2\theta}$$
$$\dot p_\theta = \frac{p_\phi^2\cos\theta}{m l^2\sin^3\theta} - m g l\sin\theta, \qquad
  \dot p_\phi = 0$$
"""

COLUMNS = r"""
$$\begin{pmatrix} x_1 \\ y_1 \end{pmatrix}
  = \begin{pmatrix} \ell\sin\psi \\ -\ell\cos\psi \end{pmatrix}$$
$$\mathcal L = \frac12 m\ell^2\dot\psi^2 + mg\ell\cos\psi$$
$$\frac{\mathrm d}{\mathrm dt}\frac{\partial\mathcal L}{\partial\dot\psi}
  - \frac{\partial\mathcal L}{\partial\psi} = m\ell^2\ddot\psi + mg\ell\sin\psi = 0$$
$$\ddot\psi = -\frac g\ell\sin\psi \approx -\frac g\ell\psi$$
"""

DERIVATIONS = {
    "double": DOUBLE,
    "cart": CART,
    "spring": SPRING,
    "robot": ROBOT,
    "hamilton": HAMILTON,
    "columns": COLUMNS,
}
