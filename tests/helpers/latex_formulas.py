"""Formulas in LaTeX and the trees that they are, by the rule that they need."""

LETTERS = r"""
\ddot x  ⟶  x..
\dot x_1  ⟶  x_1.
\dot{\theta}_1  ⟶  theta_1.
\dot{\theta_1}  ⟶  theta_1.
\dot\theta_1  ⟶  theta_1.
\dot\theta_1^2  ⟶  theta_1.^2
\dot{x}^{2}  ⟶  x.^2
\dot{{x}}  ⟶  x.
\ddot{{{x}_2}}  ⟶  x_2..
\dot\theta^2_1  ⟶  theta_1.^2
\ddot{\theta}{}_1  ⟶  theta_1..
{\theta}_1^2  ⟶  theta_1^2
\dot{x}\_p  ⟶  x_p.
x''^2  ⟶  x''^2
x^{\prime}_1  ⟶  x_1'
x_1'  ⟶  x_1'
\bar\theta'  ⟶  thetabar'
\tilde{x}_1  ⟶  xtilde_1
\hat{\mathbf{e}}_r  ⟶  bold ehat_r
\mathbf{\dot{q}}  ⟶  bold q.
\dot{\vec r}_1  ⟶  bold r_1.
\boldsymbol{q}_1  ⟶  bold q_1
\mathcal{L}_1  ⟶  L_1
\mathscr L  ⟶  L
\ell  ⟶  ell
T_{\text{kin}}  ⟶  T_kin
T_\mathrm{kin}  ⟶  T_kin
E_{\rm kin}  ⟶  E_kin
p_{\theta_1}  ⟶  p_theta_1
p_{\dot\theta}  ⟶  p_dottheta
w_{i+1}  ⟶  w_i+1
c_{f1}  ⟶  c_f1
I_{xx}  ⟶  I_xx
x_{\max}  ⟶  x_max
\text{KE} + \mathrm{PE}  ⟶  (KE + PE)
\operatorname{Re} x  ⟶  Re x
\mathrm{d}t  ⟶  d t
t1 td2^2  ⟶  t_1 td_2^2
\theta1  ⟶  theta_1
A_{1}B_2  ⟶  A_1 B_2
\dddot x  ⟶  x...
\dot{\theta^2}  ⟶  dots1(theta^2)
\dot{AB}  ⟶  dots1(A B)
\dot{(x+y)}  ⟶  dots1(x + y)
\mathcal E_N = \dot{\mathcal E}_N  ⟶  E_N = E_N.
{\dot x}^2  ⟶  x.^2
{\ddot\theta}_1  ⟶  theta_1..
m x = const  ⟶  m x = const
\text{dead\_zone}  ⟶  dead_zone
I_{robot\_assembly}  ⟶  I_robot_assembly
"""

FRACTIONS = r"""
9.81  ⟶  9.81
.5 x  ⟶  .5 x
9{,}81 x  ⟶  9.81 x
2m  ⟶  2 m
2\cdot3 x  ⟶  2 3 x
\frac12  ⟶  [1 / 2]
\frac 1 2  ⟶  [1 / 2]
\frac ab c  ⟶  [a / b] c
\frac{g}l  ⟶  [g / l]
\frac12ab  ⟶  [1 / 2] a b
\tfrac12 m v^2  ⟶  [1 / 2] m v^2
\dfrac{g}{l}  ⟶  [g / l]
{a+b \over c} d  ⟶  [(a + b) / c] d
\left({a \over b}\right)  ⟶  [a / b]
1/2 m v^2  ⟶  [1 / 2] m v^2
a/b/c  ⟶  [[a / b] / c]
a/(b+c)  ⟶  [a / (b + c)]
(a+b)/2  ⟶  [(a + b) / 2]
g/l \sin\theta  ⟶  [g / l] sin(theta)
p^2/(2m)  ⟶  [p^2 / 2 m]
p^2/2ml^2  ⟶  [p^2 / 2 m l^2]
p^2/2m x  ⟶  [p^2 / 2 m] x
m g l/2 + 1  ⟶  (m g [l / 2] + 1)
a + -b c - d  ⟶  (a + (- b c) - d)
a \cdot -b^2 + c  ⟶  (a (- b^2) + c)
2\times-\frac{a}{b} c  ⟶  2 (- [a / b] c)
\sin(\theta)/2  ⟶  [sin(theta) / 2]
g\sin\theta/l  ⟶  g [sin(theta) / l]
x(t)/y(t)  ⟶  [x@(t) / y@(t)]
10^{-3}  ⟶  10^(- 3)
x^ab  ⟶  x^a b
x^{a+b}  ⟶  x^(a + b)
e^{i\omega t}  ⟶  e^(i omega t)
\sqrt2 x  ⟶  root2(2) x
\sqrt\frac{g}{l}  ⟶  root2([g / l])
\sqrt[3]{x}  ⟶  root3(x)
\sqrt{2gl}  ⟶  root2(2 g l)
90^\circ  ⟶  90^circ
t^\star  ⟶  t^star
F^{\text{ext}}  ⟶  F^ext
"""

FUNCTIONS = r"""
\sin\theta  ⟶  sin(theta)
sin\theta  ⟶  sin(theta)
cos{\theta}  ⟶  cos(theta)
lmsin{\theta}cos{\theta}  ⟶  l m sin(theta) cos(theta)
mcos^2{\theta}  ⟶  m cos(theta)^2
\sin^2\theta  ⟶  sin(theta)^2
\sin^2(\theta)  ⟶  sin(theta)^2
\sin^{2}{\left(\theta\right)}  ⟶  sin(theta)^2
\sin\left(\theta\right)^2  ⟶  sin(theta)^2
\sin{\left(x\right)}^2  ⟶  sin(x)^2
\sin\theta^2  ⟶  sin(theta^2)
\cos(\theta_1-\theta_2)\dot\theta_1  ⟶  cos(theta_1 - theta_2) theta_1.
\cos{\left(\theta_1-\theta_2\right)}  ⟶  cos(theta_1 - theta_2)
\sin[2(\theta_1-\theta_2)]  ⟶  sin(2 (theta_1 - theta_2))
\sin 2\theta  ⟶  sin(2 theta)
\sin 2\theta l  ⟶  sin(2 theta) l
\sin k\theta l  ⟶  sin(k theta) l
\cos\omega t  ⟶  cos(omega t)
\cos\omega_0t + 1  ⟶  (cos(omega_0 t) + 1)
\sin\theta\cos\theta  ⟶  sin(theta) cos(theta)
\sin\theta\,\dot\theta  ⟶  sin(theta) theta.
\sin\theta_1 l_1  ⟶  sin(theta_1) l_1
\sin\theta (l_0+x)  ⟶  sin(theta) (l_0 + x)
\sin q_2\,(a+b)  ⟶  sin(q_2) (a + b)
\sin^2\theta(a+b)  ⟶  sin(theta)^2 (a + b)
\sin\alpha\beta  ⟶  sin(alpha) beta
\sin\dot\theta\theta  ⟶  sin(theta.) theta
\sin\frac{\theta}{2} l  ⟶  sin([theta / 2]) l
\sin\sqrt{x} l  ⟶  sin(root2(x)) l
\sin x\cos x  ⟶  sin(x) cos(x)
\sin x\frac{a}{b}  ⟶  sin(x) [a / b]
\sin x\dot x  ⟶  sin(x) x.
\sin kx  ⟶  sin(k x)
\sin\pi x  ⟶  sin(pi x)
\sin 2\pi f t  ⟶  sin(2 pi f t)
\sin k t x  ⟶  sin(k t) x
\sin\theta(t)  ⟶  sin(theta@(t))
\sin x(t)\,\dot x(t)  ⟶  sin(x@(t)) x.@(t)
\cos 2(\theta_1-\theta_2) x  ⟶  cos(2 (theta_1 - theta_2)) x
\cos 2\cdot\theta  ⟶  cos(2 theta)
\sin 2\dot\theta  ⟶  sin(2 theta.)
\sin 2\frac{a}{b} c  ⟶  sin(2 [a / b]) c
\sin|x|  ⟶  sin(|x|)
\sin(x)(y)  ⟶  sin(x) y
\sin\cos x  ⟶  sin(cos(x))
\sin^{-1} x  ⟶  asin(x)
\arctan\frac{y}{x}  ⟶  atan([y / x])
\tan^{-1}(y/x)  ⟶  atan([y / x])
\arctan2(y,x)  ⟶  atan2(<y, x>)
\operatorname{atan2}(y, x)  ⟶  atan2(<y, x>)
\operatorname{sgn}(\dot q)  ⟶  sign(q.)
\text{sgn}\,\dot q  ⟶  sign(q.)
\text{sgn}\,\,\,\,\,\,\,\,\,\,\,\, \dot q  ⟶  sign(q.)
\mathrm{sin}\,\theta  ⟶  sin(theta)
\ln\left|x\right|  ⟶  log(|x|)
y = a + ln x  ⟶  y = (a + log(x))
y = aln x  ⟶  y = a l n x
\exp(-t/\tau)  ⟶  exp(- [t / tau])
\det(A)  ⟶  det(A)
\det\mathbf{M}  ⟶  det(bold M)
5\text{sec}  ⟶  5 sec
\cosh x  ⟶  cosh(x)
mgl \space cos\theta  ⟶  m g l cos(theta)
mcos2\theta  ⟶  m cos(2 theta)
\sin\Delta\cos\Delta  ⟶  sin(Delta) cos(Delta)
\sin\Delta\dot\theta  ⟶  sin(Delta) theta.
\sin\Delta t  ⟶  sin(Delta t)
\sin(\Delta\theta)  ⟶  sin(Delta theta)
\cos{\left(\theta_{1}{\left(t \right)} \right)}  ⟶  cos(theta_1@(t))
"""

BRACKETS = r"""
\left[ a + b \right]^2  ⟶  (a + b)^2
\bigl\{ a + b \bigr\} c  ⟶  (a + b) c
\Big( a + b \Big) c  ⟶  (a + b) c
\Bigg| x \Bigg|  ⟶  |x|
\left| x \right|^2  ⟶  |x|^2
|a||b|  ⟶  |a| |b|
|a + |b||  ⟶  |(a + |b|)|
|\,\,\,\,\,\,\,\,\,|x| + y|  ⟶  |(|x| + y)|
y \mathrm{x + 1}  ⟶  y (x + 1)
\|\vec r\|^3  ⟶  |bold r|^3
x = 2 a \cdots (3b)  ⟶  x = 2 a
\bar r \times \bar v  ⟶  cross(<rbar, vbar>)
\vec r \times m\vec v  ⟶  cross(<bold r, m bold v>)
3\hat x \times (2\hat y)  ⟶  3 cross(<xhat, 2 yhat>)
\lvert x\rvert  ⟶  |x|
\left.x\right|_{t=0}  ⟶  at(x)
m \left.\frac{\partial V}{\partial x}\right|_{x_0} u  ⟶  m at(∂(V; x)) u
T = m v^2, (1.23)  ⟶  T = m v^2
T = m v^2. (1.24)  ⟶  T = m v^2
\omega = \sqrt{g\over l}  ⟶  omega = root2([g / l])
A = \pmatrix{a & b \cr c & d}  ⟶  A = [a, b; c, d]
q = \left[\array{x \\ \theta}\right]  ⟶  q = [x; theta]
K.E. = \frac{m v^2}{2}  ⟶  KE = [m v^2 / 2]
K.E.+P.E.=E  ⟶  (KE + PE) = E
T = \sum_{kl} M_{kl} u_k u_l  ⟶  T = sum(sum(M_kl u_k u_l; l = ..); k = ..)
(x, y)  ⟶  <x, y>
[x, \dot x]^T  ⟶  <x, x.>^T
x(t)  ⟶  x@(t)
\theta_1(t)  ⟶  theta_1@(t)
\dot\theta(t)^2  ⟶  theta.@(t)^2
L(\theta,\dot\theta)  ⟶  L@(theta, theta.)
L[\theta,\dot\theta]  ⟶  L@(theta, theta.)
m(x+y)  ⟶  m@((x + y))
m[x+y]  ⟶  m (x + y)
m\bigl(x+y\bigr)  ⟶  m@((x + y))
m(x+y)^2  ⟶  m@((x + y))^2
m\left(x+y\right)z  ⟶  m@((x + y)) z
2(x+y)  ⟶  2 (x + y)
x^2(a+b)^2  ⟶  x^2 (a + b)^2
(a+b)(c+d)  ⟶  (a + b) (c + d)
f'(x)  ⟶  f'@(x)
f_i(t_i + h)  ⟶  f_i@((t_i + h))
hf(t, w)  ⟶  h f@(t, w)
g(\sin\theta)l  ⟶  g@(sin(theta)) l
-(-a)  ⟶  (- (- a))
+a  ⟶  a
- a + b  ⟶  (- a + b)
(a \\ + b) c  ⟶  (a + b) c
\left( a + \right. \\ \left. b \right) c  ⟶  (a + b) c
{+} a  ⟶  a
\theta_{1}{\left(t \right)}  ⟶  theta_1@(t)
x{\left(t \right)} y  ⟶  x@(t) y
\text{sat}(q - a)  ⟶  sat@((q - a))
-2(1) + 0  ⟶  (- 2 1 + 0)
f(3)  ⟶  f@(3)
(q(t), \dot{q}(t), t)  ⟶  <q@(t), q.@(t), t>
"""

DERIVATIVES = r"""
\frac{d}{dt}\left(\frac{\partial L}{\partial\dot q}\right)  ⟶  d(∂(L; q.); t)
{\frac{d}{dt}} x  ⟶  d(x; t)
\partial_x V  ⟶  ∂(V; x)
\partial_{\dot q} L  ⟶  ∂(L; q.)
k = \partial^2 L/\partial x^2 y z  ⟶  k = ∂(L; x, x) y z
\frac{d}{dt}\frac{\partial L}{\partial \dot q} - Q  ⟶  (d(∂(L; q.); t) - Q)
\frac{\mathrm d}{\mathrm d t} \left( m r^2 \right)  ⟶  d(m r^2; t)
\frac{\mathrm{d}x}{\mathrm{dt}}  ⟶  d(x; t)
\frac{d\theta}{dt}  ⟶  d(theta; t)
\frac{d^2\theta}{dt^2} l  ⟶  d(theta; t, t) l
\frac{d^2 x}{d t^2}  ⟶  d(x; t, t)
\frac{dp_{\theta_1}}{dt}  ⟶  d(p_theta_1; t)
\frac{d (m v)}{dt}  ⟶  d(m v; t)
\frac{d m v}{dt}  ⟶  d(m v; t)
\frac{d}{dt}(m v) x  ⟶  d(m v; t) x
\frac{d}{dt} m v x + y  ⟶  (d(m v x; t) + y)
\frac{d}{dt} \begin{pmatrix} x \\ y \end{pmatrix}  ⟶  d([x; y]; t)
\frac {\partial{\mathcal{L}}} {\partial{\theta_1}}  ⟶  ∂(L; theta_1)
\frac{-\partial H}{\partial q}  ⟶  (- ∂(H; q))
\frac{\partial^2 L}{\partial x\,\partial\dot x}  ⟶  ∂(L; x, x.)
\frac{\partial^2 L}{\partial \dot q^2}  ⟶  ∂(L; q., q.)
\frac{\partial}{\partial x}\left(a x\right) b  ⟶  ∂(a x; x) b
\frac{\partial T}{\partial \dot{q}_i}\dot q_i  ⟶  ∂(T; q_i.) q_i.
dL/dx  ⟶  d(L; x)
d^2x/dt^2  ⟶  d(x; t, t)
m d\theta/dt  ⟶  m d(theta; t)
\partial L/\partial\dot q - x  ⟶  (∂(L; q.) - x)
k = \partial^2 L/\partial x\,\partial y  ⟶  k = ∂(L; x, y)
k = \partial^2 L/\partial x^2 y  ⟶  k = ∂(L; x, x) y
\dv{t}\left(\pdv{L}{\dot q}\right) + \dv[2]{x}{t}  ⟶  (d(∂(L; q.); t) + d(x; t, t))
\pdv{L}{x}{y}  ⟶  ∂(L; x, y)
\frac{d}{l}  ⟶  [d / l]
\frac{d x}{l}  ⟶  [d x / l]
\frac{l}{d}  ⟶  [l / d]
\frac{\partial L}{\partial \dot{q}^i}  ⟶  ∂(L; q.^i)
\frac{d^{2}}{d t^{2}} \theta_{1}{\left(t \right)}  ⟶  d(theta_1@(t); t, t)
l \frac{d}{dr}[U(r) + a] b  ⟶  l d((U@(r) + a); r) b
"""

MATRICES = r"""
A^{-1} b  ⟶  A^(- 1) b
A^T b  ⟶  A^T b
A^\top  ⟶  A^T
A^{\mathsf T}  ⟶  A^T
A^{\intercal}  ⟶  A^T
(A B)^T  ⟶  (A B)^T
\dot q^T M \dot q  ⟶  q.^T M q.
M(q)\ddot q + C(q,\dot q)\dot q  ⟶  (M@(q) q.. + C@(q, q.) q.)
\begin{pmatrix} a & b \end{pmatrix} \begin{pmatrix} x \\ y \end{pmatrix}  ⟶  [a, b] [x; y]
\left[ \begin{matrix} a \\ b \\ \end{matrix} \right]^T  ⟶  [a; b]^T
\left[ {\begin{array}{cc} a & b \\ c & d \end{array}} \right]  ⟶  [a, b; c, d]
\begin{matrix}[a, b] & c\end{matrix}  ⟶  [<a, b>, c]
\begin{bmatrix} - x & a \\ 0 & b - c \end{bmatrix}  ⟶  [(- x), a; 0, (b - c)]
\begin{vmatrix} a & b \\ c & d \end{vmatrix}  ⟶  det([a, b; c, d])
\left|\begin{matrix} a & b \\ c & d\end{matrix}\right|  ⟶  det([a, b; c, d])
M \begin{pmatrix} a \end{pmatrix}^{-1} x  ⟶  M [a]^(- 1) x
\sum_{i=1}^n m_i v_i^2 - L  ⟶  (sum(m_i v_i^2; i = 1..n) - L)
{\sum_i} a_i  ⟶  sum(a_i; i = ..)
\sum^{2}_{i=1} a_i b  ⟶  sum(a_i b; i = 1..2)
\sum\limits_i \left( a_i \right) b  ⟶  sum(a_i b; i = ..)
\sum_{i,j=1}^{2} a_{ij}  ⟶  sum(sum(a_ij; j = 1..2); i = 1..2)
\sum_{i=1}^2 \sum_{j=1}^2 a_{ij}  ⟶  sum(sum(a_ij; j = 1..2); i = 1..2)
\begin{bmatrix} a & 0 \cr 0 & b \end{bmatrix}  ⟶  [a, 0; 0, b]
\frac{\sum_i m_i x_i}{\sum_i m_i}  ⟶  [sum(m_i x_i; i = ..) / sum(m_i; i = ..)]
\sum \tau = I\alpha  ⟶  sum(tau;  = ..) = I alpha
"""

LAYOUT = r"""
\underbrace{m g}_{\text{weight}} l  ⟶  m g l
\boxed{x = 1}  ⟶  x = 1
\cancel{x} + y  ⟶  (x + y)
\color{red} x  ⟶  x
\textcolor{red}{x} + y  ⟶  (x + y)
{\color{red} x + y} z  ⟶  (x + y) z
x~y\,\!\;z  ⟶  x y z
x\phantom{y}z  ⟶  x z
x\kern2pt y  ⟶  x y
x\kern2pt  ⟶  x
x\mkern12mu\theta  ⟶  x theta
x\hspace{1.2.3cm}y  ⟶  x y
x\text{ }y  ⟶  x y
x\mathrm{\quad}y  ⟶  x y
{ \bf r} x  ⟶  bold r x
\rule{0pt}{3ex} x + y  ⟶  (x + y)
\definecolor{blue}{rgb}{0,0,1} x + y  ⟶  (x + y)
x \label{a} \tag{1} \nonumber  ⟶  x
x \hspace{1mm} y  ⟶  x y
x % y  ⟶  x
x \, .  ⟶  x
a\times b \ast c * d  ⟶  a b c d
{\bf r} + {\rm KE}  ⟶  (bold r + KE)
\displaystyle x  ⟶  x
x \mathrel{=} 1  ⟶  x = 1
a \\[2pt] + b  ⟶  (a + b)
\dot\theta_1^{\,2}  ⟶  theta_1.^2
a \;+\; b  ⟶  (a + b)
x &= a \\ &\phantom{=}\; + b  ⟶  x = (a + b)
"""

UNICODE = r"""
θ̇₁² + ẍ  ⟶  (theta_1.^2 + x..)
½ m·v² − √2  ⟶  ([1 / 2] m v^2 - root2(2))
½ m ẋ²  ⟶  [1 / 2] m x.^2
∂L/∂θ̇ × 2  ⟶  ∂(L; theta.) 2
√(x+y) z  ⟶  root2(x + y) z
𝜃₁ ẋ₁  ⟶  theta_1 x_1.
α_1 ≈ x′  ⟶  alpha_1 ~ x'
x = A cos ωt  ⟶  x = A cos(omega t)
θ″ + ω² θ = 0  ⟶  (theta'' + omega^2 theta) = 0
ω = √(g/l)  ⟶  omega = root2([g / l])
sinθ cosθ  ⟶  sin(theta) cos(theta)
x̂ ≤ ℓ  ⟶  xhat <= ell
φ̈ = −(g⁄l) sin φ  ⟶  phi.. = (- [g / l] sin(phi))
e⁻ᵗ qᵀ ⅞  ⟶  e^(- t) q^T [7 / 8]
"""

RELATIONS = r"""
x := y  ⟶  x := y
x \equiv y  ⟶  x = y
x \coloneqq y  ⟶  x := y
x =: y  ⟶  x = y
\binom{a + b}{c}  ⟶  [(a + b); c]
(E_1): & x = y + z \checkmark  ⟶  x = (y + z)
\theta:\quad \ddot\theta = 0  ⟶  theta.. = 0
[4] \to [3]: F = a  ⟶  F = a
x \approx y \simeq z  ⟶  x ~ y ~ z
a \leq b < c  ⟶  a <= b < c
x \neq 0  ⟶  x != 0
x \not= 0  ⟶  x != 0
\theta \to 0  ⟶  theta -> 0
u \in \mathbb{R}  ⟶  u in R
f(x) : y  ⟶  f@(x) : y
x \stackrel{!}{=} 0  ⟶  x = 0
x \stackrel{.}{=} 0  ⟶  x = 0
\overset{.}{x}^2 + \overset{\cdot\cdot}{\theta }_1  ⟶  (x.^2 + theta_1..)
\pdiff{L}{\dot{\theta}} = \deriv{x}{t}  ⟶  ∂(L; theta.) = d(x; t)
\vect{r}  ⟶  bold r
x \overset{\text{def}}{=} 0  ⟶  x := 0
a = b = c  ⟶  a = b = c
"""

STATEMENTS = r"""
x = 1, y = 2;\ z = 3.  ⟶  x = 1 | y = 2 | z = 3
x = 1 , \qquad y = 2  ⟶  x = 1 | y = 2
x = 1 \quad y = 2 \quad (12)  ⟶  x = 1 | y = 2
x = 1 \qquad (2.3)  ⟶  x = 1
x = 1 \text{ and } y = 2  ⟶  x = 1 | y = 2
x = 1 \hspace{1cm} y = 2  ⟶  x = 1 | y = 2
x = 1 \hspace*{1cm} y = 2  ⟶  x = 1 | y = 2
x = 1 \kern1cm y = 2  ⟶  x = 1 | y = 2
x = 1 \text{\quad} y = 2  ⟶  x = 1 | y = 2
x = 1\text{,} y = 2  ⟶  x = 1 | y = 2
x = 1 \implies y = 2 \Rightarrow z = 3  ⟶  x = 1 | y = 2 | z = 3
\therefore x = 1  ⟶  x = 1
m_1,\, m_2 r_2  ⟶  m_1 | m_2 r_2
(q_1, q_2)  ⟶  <q_1, q_2>
i = 1, 2  ⟶  i = <1, 2>
x = 1 \quad \text{for } i = 1, 2, \dots  ⟶  x = 1 | i = <1, 2, dots>
x = a \\ y = b  ⟶  x = a | y = b
x = a \\ = b \\ = c  ⟶  x = a = b = c
x &= a, \\ &= b  ⟶  x = a = b
x = \\ a  ⟶  x = a
x = a + \\ b  ⟶  x = (a + b)
x = a \\ + b  ⟶  x = (a + b)
x = a \\ \quad + b  ⟶  x = (a + b)
x = a \\ - b  ⟶  x = (a - b)
x = a \\ - b = c  ⟶  x = a | (- b) = c
x &= a \\ &- b \\ y &= c  ⟶  x = (a - b) | y = c
x &= a \\ & b c \\ y &= d  ⟶  x = a b c | y = d
a \\ - b = 0  ⟶  (a - b) = 0
& a = b \\ & c = d  ⟶  a = b | c = d
& a + b \\ & + c = 0  ⟶  (a + b + c) = 0
-x &= a \\ -y &= b  ⟶  (- x) = a | (- y) = b
x &= a & y &= b  ⟶  x = a | y = b
x &= a & - y &= b  ⟶  x = a | (- y) = b
\begin{aligned} x &= a \\ y &= b \end{aligned}  ⟶  x = a | y = b
\begin{equation} \begin{aligned} x &= a \end{aligned} \tag{3} \end{equation}  ⟶  x = a
\begin{cases} x' &= f(t) \\ x(0) &= a \end{cases} \quad (19)  ⟶  x' = f@(t) | x@(0) = a
\left\{\begin{aligned} x &= a \\ y &= b \end{aligned}\right.  ⟶  x = a | y = b
\left\{ \begin{array}{l} x = a \\ y = b \end{array} \right.  ⟶  x = a | y = b
\begin{array}{rcl} x &=& a \\ y &=& b \end{array}  ⟶  x = a | y = b
\begin{eqnarray} x &=& a \\ &=& b \end{eqnarray}  ⟶  x = a = b
\begin{aligned}[t] x &= a \end{aligned}  ⟶  x = a
\begin{aligned}[a + b] &= c \end{aligned}  ⟶  (a + b) = c
\begin{multline} x = a \\ + b \end{multline}  ⟶  x = (a + b)
\begin{aligned}[t] x &= a \end{aligned}  ⟶  x = a
\begin{aligned}[a + b] &= c \end{aligned}  ⟶  (a + b) = c
\begin{multline} x = a \\ b + c \\ - d = e \end{multline}  ⟶  x = (a b + c - d) = e
x = \begin{split} a \\ + b \end{split}  ⟶  x = (a + b)
L &= a \intertext{and so} M &= b  ⟶  L = a | M = b
\begin{array}{r c l} x & \hspace{-1ex} =& a \\ y & \hspace{-1ex} =& b \end{array}  ⟶  x = a | y = b
L & = a \\ & + b \\ M & - c = 0, \quad d = 0  ⟶  L = (a + b) | (M - c) = 0 | d = 0
x = a \quad (b \ll 1)  ⟶  x = a | b < 1
x > 0~~(1)  ⟶  x > 0
x = a\;\;(12)  ⟶  x = a
F = a + \text{friction of air}  ⟶  F = (a + friction_of_air)
x = 1 \text{ for all } t  ⟶  x = 1 | t
\text{for }1 \le i \le n.  ⟶  1 <= i <= n
a &= b && \text{(momentum)} \\ c &= d  ⟶  a = b | c = d
\boxed{ a = b, \qquad c = d. }  ⟶  a = b | c = d
E = T + V = \text{const.}  ⟶  E = (T + V) = const
"""

UNREADABLE = r"""
x^23  ⟶  unreadable: a digit behind an exponent without braces
x_12  ⟶  unreadable: a digit behind an index without braces
x^2^3  ⟶  unreadable: '^' cannot stand here
x_1_2  ⟶  unreadable: two indices at the letter x
\partial_  ⟶  unreadable: an argument is missing
2 3  ⟶  unreadable: two numbers side by side
1e-3  ⟶  unreadable: a number with an exponent behind e
2e5  ⟶  unreadable: a number with an exponent behind e
k/mx  ⟶  unreadable: what stands below the slash is ambiguous without brackets
a/b(c+d)  ⟶  unreadable: what stands below the slash is ambiguous without brackets
\sin\theta/2  ⟶  unreadable: what stands above the slash is ambiguous without brackets
\sin\pi x/l  ⟶  unreadable: what stands above the slash is ambiguous without brackets
\sin{\theta}^2  ⟶  unreadable: an exponent of the function or of its argument
\sin k x  ⟶  unreadable: where the argument of a function ends is ambiguous without brackets
\sin x (a+b)  ⟶  unreadable: where the argument of a function ends is ambiguous without brackets
\sin x(a+b)  ⟶  unreadable: where the argument of a function ends is ambiguous without brackets
\cos 2(\theta)^2  ⟶  unreadable: where the argument of a function ends is ambiguous without brackets
\log_{10} x  ⟶  unreadable: the base of a logarithm
\sin^{-2} x  ⟶  unreadable: a negative power of a function before its argument
\sin' x  ⟶  unreadable: a prime behind a function
\int x  ⟶  unreadable: an integral
\nabla f  ⟶  unreadable: the operator nabla
\prod_i x_i  ⟶  unreadable: a product over an index
\sum_{i<j} a  ⟶  unreadable: a sum over a condition
\sum_i  ⟶  unreadable: a sum has no terms
a - -b  ⟶  unreadable: '-' cannot stand here
\vec a \times \vec b \times \vec c  ⟶  unreadable: a vector product
\vec r \times 2  ⟶  unreadable: a vector product
\frac{d}{dt}  ⟶  unreadable: a derivative has no operand
\frac{\partial L}{x}  ⟶  unreadable: ∂ outside of a derivative
\frac{\partial^2 L}{\partial x}  ⟶  unreadable: the orders above and below a derivative differ
\frac{\Delta x}{\Delta t}  ⟶  unreadable: a quotient of differences or variations
\overline{AB}  ⟶  unreadable: \overline over an expression that is no letter
(a+b)_1  ⟶  unreadable: an index behind an expression that is no letter
(a+b)'  ⟶  unreadable: a prime behind an expression that is no letter
x^{(2)}  ⟶  unreadable: a number in brackets in the place of an exponent
A^{-T}  ⟶  unreadable: the transpose of an inverse
(x  ⟶  unreadable: a bracket is never closed
x)  ⟶  unreadable: a bracket is closed but never opened
[x)  ⟶  unreadable: a bracket is never closed
{x  ⟶  unreadable: a brace is never closed
x}  ⟶  unreadable: a brace is closed but never opened
|x  ⟶  unreadable: a bar has no partner
x^  ⟶  unreadable: an argument is missing
\frac{1}  ⟶  unreadable: an argument is missing
()  ⟶  unreadable: '(' cannot stand here
x +   ⟶  unreadable: the expression ends too early
* x  ⟶  unreadable: '*' cannot stand here
\foo x  ⟶  unreadable: the command \foo is not known
x!  ⟶  unreadable: '!' cannot stand here
θ₁̇  ⟶  unreadable: the accent '̇' has no letter
x =   ⟶  unreadable: a side of a relation is missing
= x  ⟶  unreadable: a side of a relation is missing
\begin{foo} x \end{foo}  ⟶  unreadable: the environment 'foo' is not known
\begin{pmatrix} x  ⟶  unreadable: \begin{pmatrix} has no \end
\begin{pmatrix} a & \\ & b \end{pmatrix}  ⟶  unreadable: an entry of a matrix is empty
\begin{pmatrix} a & b \\ c \end{pmatrix}  ⟶  unreadable: the rows of a matrix have different lengths
f = \begin{cases} 1 & x < 0 \\ 2 & x > 0 \end{cases}  ⟶  unreadable: a definition by cases
(a \\ b) c  ⟶  unreadable: a new row in brackets
x_{a=1}  ⟶  unreadable: an index that is neither letters, numbers nor a word
a = (b = c  ⟶  a = c | unreadable: a bracket is never closed
x = a \\ y = \foo \\ z = b  ⟶  x = a | unreadable: the command \foo is not known | z = b
x = a = \foo = b  ⟶  x = a = b | unreadable: the command \foo is not known
\cos\Delta\theta  ⟶  unreadable: where the argument of a function ends is ambiguous without brackets
x/\Delta t  ⟶  unreadable: what stands below the slash is ambiguous without brackets
\frac{a}{b}(3)  ⟶  unreadable: a number in brackets, which may be that of the equation
\frac{\partial d}{\partial dt} x  ⟶  unreadable: ∂ outside of a derivative
{}^{S}J  ⟶  unreadable: '^' cannot stand here
"""
