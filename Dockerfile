# JupyterLab with the lessons: for one machine, for a hub (--target hub): docs/install.md.
# The image holds quadprog (GPL): passing it on has conditions, see NOTICE.md.
FROM python:3.11.14-slim-bookworm AS base

WORKDIR /opt/cdprlab
COPY requirements.txt pyproject.toml README.md LICENSE NOTICE.md ./
# The pinned packages first: they change less often than cdprlab, and stay cached.
RUN grep -v '^-e' requirements.txt > pinned.txt && pip install --no-cache-dir --only-binary pybullet -r pinned.txt
COPY lessons/*.ipynb lessons/
COPY worlds worlds
COPY cdprlab cdprlab
RUN pip install --no-cache-dir --no-deps .
# Compiled once, for any processor of this kind, where a student's process may write as well.
ENV NUMBA_CACHE_DIR=/opt/cdprlab/compiled NUMBA_CPU_NAME=generic
RUN python -m cdprlab.compiled && chmod -R a+rwX "$NUMBA_CACHE_DIR"
# Nothing may be missing without a word: PyPI has no PyBullet for linux/arm64. Build with --platform linux/amd64,
# or say --build-arg WITHOUT_ENGINE=yes for an image whose spatial worlds can be computed with, but not flown.
ARG WITHOUT_ENGINE=
RUN cdprlab doctor || test -n "$WITHOUT_ENGINE"

# Students cannot write where the packages are; they work in their home. The lessons go there as the container starts,
# because a volume mounted over the home hides what the image has in it; they never overwrite work.
RUN useradd --create-home --uid 1000 student
WORKDIR /home/student
ENTRYPOINT ["sh", "-c", "cdprlab lessons \"$HOME/my_lessons\" && exec \"$@\"", "sh"]
EXPOSE 8888

# The hub's own version, for example --build-arg JUPYTERHUB=5
FROM base AS hub
ARG JUPYTERHUB=5
RUN pip install --no-cache-dir "jupyterhub==$JUPYTERHUB.*"
USER student
CMD ["jupyterhub-singleuser"]

# Where `python -m cdprlab grade` runs students' code if there is no bubblewrap: --target grading -t cdprlab-grading.
# Recorded answers are not for them, numba wants to write beside its compiled code though nothing else can be written,
# and no container outlives ten minutes, whatever becomes of who started it.
FROM base AS grading
RUN rm -r "$(python -c 'import cdprlab; print(cdprlab.__path__[0])')/course/answers/recorded"
USER nobody
WORKDIR /tmp
ENTRYPOINT ["sh", "-c", "cp -r /opt/cdprlab/compiled . && NUMBA_CACHE_DIR=/tmp/compiled exec timeout --signal=KILL 600 python \"$@\"", "sh"]
CMD ["-m", "cdprlab.course.grading.worker"]

FROM base AS lab
USER student
CMD ["jupyter", "lab", "--ip=0.0.0.0", "--no-browser", "--notebook-dir=my_lessons"]
