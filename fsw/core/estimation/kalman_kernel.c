/* Kalman prediction and update, and products of matrices, in a fixed order of sums.

   Every sum runs over its index in rising order and is rounded after each multiplication and each addition.
   Compiled without contraction (-ffp-contract=off) and without -ffast-math, IEEE doubles then give the same bits
   on every machine. Inner loops run over independent sums side by side, so that they vectorise without
   reordering. Matrices are C-contiguous doubles by rows; P is symmetric, and stays exactly so. */

#define PY_SSIZE_T_CLEAN
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#include <Python.h>
#include <numpy/arrayobject.h>
#include <math.h>

#ifndef SOURCE_SHA256
#define SOURCE_SHA256 ""
#endif

#define MOST_STATES 64
#define MOST_MEASURED 6
#define LANES 8 /* measured numbers, padded so that their sums vectorise */

/* out (m,n) = A (m,k) B (k,n) */
static void multiply(int m, int k, int n, const double *restrict A, const double *restrict B,
                     double *restrict out)
{
    for (int i = 0; i < m; i++) {
        double *row = out + (size_t)i * n;
        for (int c = 0; c < n; c++) row[c] = 0.0;
        for (int j = 0; j < k; j++) {
            const double factor = A[(size_t)i * k + j];
            const double *b = B + (size_t)j * n;
            for (int c = 0; c < n; c++) row[c] += factor * b[c];
        }
    }
}

/* out = F P F^T + Q, F being the first k rows of the transition (k,n), the others those of the identity */
static void predict(int n, int k, const double *restrict P, const double *restrict F, const double *restrict Q,
                    double *restrict out)
{
    double rows[MOST_STATES * MOST_STATES];
    multiply(k, n, n, F, P, rows);
    for (int i = 0; i < k; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = 0.0;
            for (int c = 0; c < n; c++) sum += rows[i * n + c] * F[j * n + c];
            out[i * n + j] = sum + Q[i * n + j];
            out[j * n + i] = out[i * n + j];
        }
        for (int c = k; c < n; c++) {
            out[i * n + c] = rows[i * n + c] + Q[i * n + c];
            out[c * n + i] = out[i * n + c];
        }
    }
    for (int i = k; i < n; i++)
        for (int c = k; c < n; c++) out[i * n + c] = P[i * n + c] + Q[i * n + c];
}

/* Gauss-Jordan with partial pivoting; 1: M (m,m) is singular */
static int invert(int m, const double *M, double *inverse)
{
    double a[MOST_STATES * MOST_STATES];
    for (int i = 0; i < m * m; i++) { a[i] = M[i]; inverse[i] = 0.0; }
    for (int i = 0; i < m; i++) inverse[i * m + i] = 1.0;
    for (int c = 0; c < m; c++) {
        int pivot = c;
        for (int r = c + 1; r < m; r++)
            if (fabs(a[r * m + c]) > fabs(a[pivot * m + c])) pivot = r;
        if (a[pivot * m + c] == 0.0) return 1;
        if (pivot != c)
            for (int k = 0; k < m; k++) {
                double kept = a[pivot * m + k];
                a[pivot * m + k] = a[c * m + k];
                a[c * m + k] = kept;
                kept = inverse[pivot * m + k];
                inverse[pivot * m + k] = inverse[c * m + k];
                inverse[c * m + k] = kept;
            }
        const double factor = 1.0 / a[c * m + c];
        for (int k = 0; k < m; k++) { a[c * m + k] *= factor; inverse[c * m + k] *= factor; }
        for (int r = 0; r < m; r++) {
            if (r == c) continue;
            const double part = a[r * m + c];
            for (int k = 0; k < m; k++) {
                a[r * m + k] -= part * a[c * m + k];
                inverse[r * m + k] -= part * inverse[c * m + k];
            }
        }
    }
    return 0;
}

/* out (n,8) = A (n,n) B^T, B being (m,n): column i of the result in lane i, zero beyond m */
static void times_transposed(int n, int m, const double *restrict A, const double *restrict B,
                             double *restrict out)
{
    double columns[MOST_STATES * LANES];
    for (int k = 0; k < n; k++)
        for (int i = 0; i < LANES; i++) columns[k * LANES + i] = i < m ? B[i * n + k] : 0.0;
    for (int r = 0; r < n; r++) {
        double sums[LANES] = {0.0};
        for (int k = 0; k < n; k++) {
            const double factor = A[r * n + k];
            for (int i = 0; i < LANES; i++) sums[i] += factor * columns[k * LANES + i];
        }
        for (int i = 0; i < LANES; i++) out[r * LANES + i] = sums[i];
    }
}

/* S = H P H^T + R, K = P H^T S^-1 with zero rows from first to last, x = K y,
   out = (1 - K H) P (1 - K H)^T + K R K^T, expanded from the left, then from the right.
   All (n) columns of K^T lie side by side in gain (m,n). 1: S is singular */
static int update(int n, int m, const double *restrict P, const double *restrict H, const double *restrict R,
                  const double *restrict y, int first, int last, double *restrict out, double *restrict x,
                  double *restrict K, double *restrict S, double *restrict SI)
{
    double ph[MOST_MEASURED * MOST_STATES], gain[MOST_MEASURED * MOST_STATES];
    double left_ht[MOST_STATES * LANES];
    multiply(m, n, n, H, P, ph); /* (P H^T)^T, as P is symmetric */
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) {
            double sum = 0.0;
            for (int k = 0; k < n; k++) sum += H[i * n + k] * ph[j * n + k];
            S[i * m + j] = sum + R[i * m + j];
        }
    if (invert(m, S, SI)) return 1;
    for (int i = 0; i < m; i++) {
        double *row = gain + i * n;
        for (int c = 0; c < n; c++) row[c] = 0.0;
        for (int k = 0; k < m; k++) {
            const double factor = SI[k * m + i];
            for (int c = 0; c < n; c++) row[c] += factor * ph[k * n + c];
        }
        for (int c = first; c < last; c++) row[c] = 0.0;
    }
    for (int c = 0; c < n; c++) x[c] = 0.0;
    for (int i = 0; i < m; i++)
        for (int c = 0; c < n; c++) x[c] += gain[i * n + c] * y[i];
    for (int r = 0; r < n; r++) { /* P - K H P */
        double *row = out + r * n;
        for (int c = 0; c < n; c++) row[c] = P[r * n + c];
        for (int i = 0; i < m; i++) {
            const double factor = gain[i * n + r];
            for (int c = 0; c < n; c++) row[c] -= factor * ph[i * n + c];
        }
    }
    times_transposed(n, m, out, H, left_ht);
    for (int r = 0; r < n; r++) {
        double *row = out + r * n;
        for (int i = 0; i < m; i++) {
            double change = 0.0; /* K R - (P - K H P) H^T */
            for (int k = 0; k < m; k++) change += gain[k * n + r] * R[k * m + i];
            change -= left_ht[r * LANES + i];
            for (int c = 0; c < n; c++) row[c] += change * gain[i * n + c];
        }
    }
    for (int r = 0; r < n; r++)
        for (int c = 0; c < r; c++)
            out[r * n + c] = out[c * n + r] = 0.5 * (out[r * n + c] + out[c * n + r]);
    for (int i = 0; i < m; i++)
        for (int c = 0; c < n; c++) K[c * m + i] = gain[i * n + c];
    return 0;
}

/* A matrix (rows, columns) of doubles, contiguous; -1: any number of these. NULL with an exception otherwise. */
static PyArrayObject *matrix(PyObject *given, npy_intp rows, npy_intp columns, const char *name)
{
    PyArrayObject *array = (PyArrayObject *)PyArray_FROM_OTF(given, NPY_DOUBLE, NPY_ARRAY_IN_ARRAY);
    if (array == NULL) return NULL;
    if (PyArray_NDIM(array) != 2 || (rows >= 0 && PyArray_DIM(array, 0) != rows) ||
        (columns >= 0 && PyArray_DIM(array, 1) != columns)) {
        PyErr_Format(PyExc_ValueError, "%s is not a matrix of this size", name);
        Py_DECREF(array);
        return NULL;
    }
    return array;
}

static PyObject *empty(int dimensions, npy_intp rows, npy_intp columns)
{
    npy_intp shape[2] = {rows, columns};
    return PyArray_SimpleNew(dimensions, shape, NPY_DOUBLE);
}

static double *numbers(PyObject *array) { return (double *)PyArray_DATA((PyArrayObject *)array); }

/* predict(P, F, Q) -> P */
static PyObject *py_predict(PyObject *self, PyObject *const *given, Py_ssize_t count)
{
    PyArrayObject *P = NULL, *F = NULL, *Q = NULL;
    PyObject *out = NULL;
    if (count != 3) return PyErr_Format(PyExc_TypeError, "predict takes P, F and Q");
    if ((P = matrix(given[0], -1, -1, "P")) == NULL) goto done;
    const npy_intp n = PyArray_DIM(P, 0);
    if (n != PyArray_DIM(P, 1) || n > MOST_STATES) {
        PyErr_Format(PyExc_ValueError, "P is not square, or of more than %d states", MOST_STATES);
        goto done;
    }
    if ((F = matrix(given[1], -1, n, "F")) == NULL || (Q = matrix(given[2], n, n, "Q")) == NULL) goto done;
    if (PyArray_DIM(F, 0) > n) {
        PyErr_SetString(PyExc_ValueError, "F has more rows than columns");
        goto done;
    }
    if ((out = empty(2, n, n)) != NULL)
        predict((int)n, (int)PyArray_DIM(F, 0), PyArray_DATA(P), PyArray_DATA(F), PyArray_DATA(Q), numbers(out));
done:
    Py_XDECREF(P);
    Py_XDECREF(F);
    Py_XDECREF(Q);
    return out;
}

/* update(P, y, R, H, first, last) -> (x, P, K, S, SI), or None where S is singular */
static PyObject *py_update(PyObject *self, PyObject *const *given, Py_ssize_t count)
{
    PyArrayObject *P = NULL, *R = NULL, *H = NULL;
    PyObject *x = NULL, *after = NULL, *K = NULL, *S = NULL, *SI = NULL, *found = NULL;
    if (count != 6) return PyErr_Format(PyExc_TypeError, "update takes P, y, R, H, first and last");
    const long first = PyLong_AsLong(given[4]), last = PyLong_AsLong(given[5]);
    if (PyErr_Occurred()) return NULL;
    if (!PyTuple_Check(given[1]))
        return PyErr_Format(PyExc_TypeError, "the innovation is a tuple of numbers");
    const Py_ssize_t m = PyTuple_GET_SIZE(given[1]);
    if (m < 1 || m > MOST_MEASURED)
        return PyErr_Format(PyExc_ValueError, "an update takes 1 to %d numbers", MOST_MEASURED);
    double y[MOST_MEASURED];
    for (Py_ssize_t i = 0; i < m; i++) y[i] = PyFloat_AsDouble(PyTuple_GET_ITEM(given[1], i));
    if (PyErr_Occurred()) return NULL;
    if ((P = matrix(given[0], -1, -1, "P")) == NULL) goto done;
    const npy_intp n = PyArray_DIM(P, 0);
    if (n != PyArray_DIM(P, 1) || n > MOST_STATES) {
        PyErr_Format(PyExc_ValueError, "P is not square, or of more than %d states", MOST_STATES);
        goto done;
    }
    if (first < 0 || first > last || last > n) {
        PyErr_SetString(PyExc_ValueError, "the considered states are none of P");
        goto done;
    }
    if ((R = matrix(given[2], m, m, "R")) == NULL || (H = matrix(given[3], m, n, "H")) == NULL) goto done;
    if ((x = empty(1, n, 0)) == NULL || (after = empty(2, n, n)) == NULL || (K = empty(2, n, m)) == NULL ||
        (S = empty(2, m, m)) == NULL || (SI = empty(2, m, m)) == NULL)
        goto done;
    if (update((int)n, (int)m, PyArray_DATA(P), PyArray_DATA(H), PyArray_DATA(R), y, (int)first, (int)last,
               numbers(after), numbers(x), numbers(K), numbers(S), numbers(SI))) {
        Py_INCREF(Py_None);
        found = Py_None;
    } else {
        found = PyTuple_Pack(5, x, after, K, S, SI);
    }
done:
    Py_XDECREF(P);
    Py_XDECREF(R);
    Py_XDECREF(H);
    Py_XDECREF(x);
    Py_XDECREF(after);
    Py_XDECREF(K);
    Py_XDECREF(S);
    Py_XDECREF(SI);
    return found;
}

/* product(A, B) -> A B */
static PyObject *py_product(PyObject *self, PyObject *const *given, Py_ssize_t count)
{
    PyArrayObject *A = NULL, *B = NULL;
    PyObject *out = NULL;
    if (count != 2) return PyErr_Format(PyExc_TypeError, "product takes A and B");
    if ((A = matrix(given[0], -1, -1, "A")) == NULL) goto done;
    if ((B = matrix(given[1], PyArray_DIM(A, 1), -1, "B")) == NULL) goto done;
    const npy_intp m = PyArray_DIM(A, 0), n = PyArray_DIM(B, 1);
    if ((out = empty(2, m, n)) != NULL)
        multiply((int)m, (int)PyArray_DIM(A, 1), (int)n, PyArray_DATA(A), PyArray_DATA(B), numbers(out));
done:
    Py_XDECREF(A);
    Py_XDECREF(B);
    return out;
}

/* inverse(M) -> M^-1, None where M is singular */
static PyObject *py_inverse(PyObject *self, PyObject *const *given, Py_ssize_t count)
{
    PyArrayObject *M = NULL;
    PyObject *out = NULL;
    if (count != 1) return PyErr_Format(PyExc_TypeError, "inverse takes a matrix");
    if ((M = matrix(given[0], -1, -1, "M")) == NULL) return NULL;
    const npy_intp m = PyArray_DIM(M, 0);
    if (m != PyArray_DIM(M, 1) || m > MOST_STATES) {
        PyErr_Format(PyExc_ValueError, "M is not square, or of more than %d rows", MOST_STATES);
    } else if ((out = empty(2, m, m)) != NULL && invert((int)m, PyArray_DATA(M), numbers(out))) {
        Py_DECREF(out);
        Py_INCREF(Py_None);
        out = Py_None;
    }
    Py_DECREF(M);
    return out;
}

/* combine(numbers, rows) -> the sum of each number times its row, (n) */
static PyObject *py_combine(PyObject *self, PyObject *const *given, Py_ssize_t count)
{
    PyArrayObject *rows = NULL;
    PyObject *out = NULL;
    if (count != 2 || !PyTuple_Check(given[0]))
        return PyErr_Format(PyExc_TypeError, "combine takes a tuple of numbers and as many rows");
    const Py_ssize_t k = PyTuple_GET_SIZE(given[0]);
    double factors[MOST_STATES];
    if (k > MOST_STATES) return PyErr_Format(PyExc_ValueError, "at most %d numbers are combined", MOST_STATES);
    for (Py_ssize_t j = 0; j < k; j++) factors[j] = PyFloat_AsDouble(PyTuple_GET_ITEM(given[0], j));
    if (PyErr_Occurred()) return NULL;
    if ((rows = matrix(given[1], k, -1, "rows")) == NULL) return NULL;
    const npy_intp n = PyArray_DIM(rows, 1);
    if ((out = empty(1, n, 0)) != NULL)
        multiply(1, (int)k, (int)n, factors, PyArray_DATA(rows), numbers(out));
    Py_DECREF(rows);
    return out;
}

static PyMethodDef methods[] = {
    {"predict", (PyCFunction)(void (*)(void))py_predict, METH_FASTCALL, "predict(P, F, Q) -> P"},
    {"update", (PyCFunction)(void (*)(void))py_update, METH_FASTCALL,
     "update(P, y, R, H, first, last) -> (x, P, K, S, SI), None where S is singular"},
    {"product", (PyCFunction)(void (*)(void))py_product, METH_FASTCALL, "product(A, B) -> A B"},
    {"inverse", (PyCFunction)(void (*)(void))py_inverse, METH_FASTCALL,
     "inverse(M) -> M^-1, None where M is singular"},
    {"combine", (PyCFunction)(void (*)(void))py_combine, METH_FASTCALL,
     "combine(numbers, rows) -> the sum of each number times its row"},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "_kalman_kernel", "The filter's algebra in a fixed order of sums.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit__kalman_kernel(void)
{
    import_array();
    PyObject *made = PyModule_Create(&module);
    if (made != NULL && PyModule_AddStringConstant(made, "SOURCE_SHA256", SOURCE_SHA256) < 0) Py_CLEAR(made);
    return made;
}
