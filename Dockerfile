# JupyterLab with the lessons, for one machine or a hub: docs/instructors.md.
# The image holds quadprog (GPL): passing it on has conditions, see NOTICE.md.
FROM python:3.11-slim

WORKDIR /opt/cdprlab
COPY requirements.txt pyproject.toml README.md LICENSE NOTICE.md ./
# The pinned packages first: they change less often than cdprlab, and stay cached.
RUN grep -v '^-e' requirements.txt > pinned.txt && pip install --no-cache-dir --only-binary pybullet -r pinned.txt
COPY worlds worlds
COPY cdprlab cdprlab
RUN pip install --no-cache-dir --no-deps .
# Compiled once, where a student's process may write as well: on another processor it compiles anew.
ENV NUMBA_CACHE_DIR=/opt/cdprlab/compiled
RUN python -m cdprlab.compiled && chmod -R a+rwX "$NUMBA_CACHE_DIR"
COPY lessons/[0-9]*.ipynb lessons/my_lessons.py lessons/

# A hub's own version, for example --build-arg JUPYTERHUB=5
ARG JUPYTERHUB=
RUN if [ -n "$JUPYTERHUB" ]; then pip install --no-cache-dir "jupyterhub==$JUPYTERHUB.*"; fi

# Students cannot write where the packages are; they work in their home.
RUN useradd --create-home --uid 1000 student
USER student
WORKDIR /home/student
EXPOSE 8888
CMD ["sh", "-c", "python /opt/cdprlab/lessons/my_lessons.py my_lessons && cd my_lessons && exec jupyter lab --ip=0.0.0.0 --no-browser"]
